"""The dashboard and the alert rules of `deploy/`: every measurement they ask for is one that there is."""

import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest
import yaml
from prometheus_client.parser import text_string_to_metric_families

from grader.contracts.report import GradeStatus
from grader.contracts.submission import WorkerState
from grader.contracts.telemetry import QueueDepth, ServiceState
from grader.operation.metrics import Metrics
from tests.fakes.clock import START

DEPLOY = Path(__file__).resolve().parents[3] / "deploy"
RULES = DEPLOY / "grader.rules.yaml"
_WORD = re.compile(r"\b((?:grader|process)_[a-z_]+)(?:\{([^}]*)\})?")


@pytest.fixture(scope="module")
def samples() -> dict[str, set[str]]:
    """What a service measures: the labels of each sample, by its name."""
    depth = QueueDepth(state="queued", priority=0, count=1)
    worker = WorkerState(
        id="w", slots=1, busy=0, sandbox_ready=True, isolation="", detail="", started_at=START, seen_at=START
    )
    state = ServiceState(
        at=START, depths=(depth,), oldest_queued_at=START, workers=(worker,), free_bytes=10**9
    )
    metrics = Metrics(lambda: state)
    metrics.uploaded("accepted")
    metrics.requested("GET", "/", 200, 0.1)
    metrics.measure_streams(lambda: 0)
    metrics.graded(GradeStatus.GRADED, 0.1, 0.1)
    text = metrics.exposition().decode()
    found: dict[str, set[str]] = {}
    for family in text_string_to_metric_families(text):
        for one in family.samples:
            found.setdefault(one.name, set()).update(one.labels)
    return found


def dashboard() -> dict[str, Any]:
    document: dict[str, Any] = json.loads((DEPLOY / "grader.dashboard.json").read_text(encoding="utf-8"))
    return document


def rules() -> list[dict[str, Any]]:
    groups = yaml.safe_load(RULES.read_text(encoding="utf-8"))["groups"]
    return [rule for group in groups for rule in group["rules"]]


def expressions() -> list[str]:
    shown = [target["expr"] for panel in dashboard()["panels"] for target in panel["targets"]]
    return [*shown, *(rule["expr"] for rule in rules())]


@pytest.mark.parametrize("expression", expressions())
def test_what_is_asked_for_is_measured(expression: str, samples: dict[str, set[str]]) -> None:
    asked = _WORD.findall(expression)
    assert asked
    for name, matchers in asked:
        assert name in samples
        for label in re.findall(r"([a-z_]+)=", matchers):
            assert label in samples[name]
        grouped = re.search(r"by \(([^)]*)\)", expression)
        for label in (grouped.group(1) if grouped else "").replace(" ", "").split(","):
            assert not label or label in samples[name]


def test_every_alert_says_what_it_means() -> None:
    assert len({rule["alert"] for rule in rules()}) == len(rules()) > 5
    for rule in rules():
        assert set(rule) <= {"alert", "expr", "for", "labels", "annotations"}
        assert rule["labels"]["severity"] in {"page", "warn"}
        assert rule["annotations"]["summary"].endswith(".")


def test_the_dashboard_has_what_grafana_needs() -> None:
    document = dashboard()
    assert (document["title"], document["uid"], document["schemaVersion"]) == ("Auto-grader", "grader", 39)
    (variable,) = document["templating"]["list"]
    taken: set[tuple[int, int]] = set()
    for panel in document["panels"]:
        assert panel["type"] in {"timeseries", "stat"}
        assert panel["datasource"] == {"type": "prometheus", "uid": f"${{{variable['name']}}}"}
        place = panel["gridPos"]
        assert place["x"] + place["w"] <= 24
        cells = {
            (x, y)
            for x in range(place["x"], place["x"] + place["w"])
            for y in range(place["y"], place["y"] + place["h"])
        }
        assert not cells & taken
        taken |= cells
        assert [one["refId"] for one in panel["targets"]] == list("ABCDEF"[: len(panel["targets"])])
    assert len({panel["id"] for panel in document["panels"]}) == len(document["panels"])


@pytest.mark.skipif(shutil.which("promtool") is None, reason="there is no promtool")
def test_prometheus_takes_the_rules() -> None:
    done = subprocess.run(
        ["promtool", "check", "rules", str(RULES)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
