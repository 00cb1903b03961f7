"""The doctor reports what it tried."""

import json
import re
from pathlib import Path

import pytest
from sqlalchemy import make_url

from grader.commands import doctor
from grader.commands.cli import run
from grader.commands.doctor import State, run_doctor
from grader.jail import landlock, layers
from grader.jail.layers import Layer

pytestmark = pytest.mark.skipif(landlock.abi_version() == 0, reason="this kernel has no Landlock")

RUNNER = Path(__file__).parents[2] / "hostile" / "runner"


@pytest.fixture(autouse=True)
def _few_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "_TIMED_RUNS", 2)


def test_a_good_host_is_ready() -> None:
    diagnosis = run_doctor(RUNNER, "bare_runner:run")
    assert diagnosis.exit_code == 0
    assert {finding.layer for finding in diagnosis.findings if finding.state is State.ACTIVE} >= {
        Layer.PROCESS,
        Layer.RLIMITS,
        Layer.SECCOMP,
        Layer.LANDLOCK,
    }
    assert json.loads(json.dumps(diagnosis.to_dict()))["exit_code"] == 0
    assert "Ready for strict mode" in diagnosis.text("en")
    assert "严格模式" in diagnosis.text("zh")


def test_a_host_without_landlock_is_reduced_and_told_what_that_means(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(layers.landlock, "abi_version", lambda: 0)
    diagnosis = run_doctor(RUNNER, "bare_runner:run")
    assert diagnosis.exit_code == 1
    (finding,) = [finding for finding in diagnosis.findings if finding.layer is Layer.LANDLOCK]
    assert finding.state is State.MISSING
    assert finding.leaves_open == doctor._LEAVES_OPEN[Layer.LANDLOCK]
    assert "reference solutions" in diagnosis.text("en")


def test_a_host_that_can_run_nothing() -> None:
    diagnosis = run_doctor(RUNNER, "no_such_module:run")
    assert diagnosis.exit_code == 2
    assert "no_such_module" in diagnosis.text("en")


def test_every_layer_and_state_has_words() -> None:
    assert set(doctor._TITLES) == set(doctor._LEAVES_OPEN) == set(Layer)
    assert set(doctor._STATES) == {state.value for state in State}


def test_a_servers_connections_are_told(
    postgres_url: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("GRADER_DATABASE_URL", postgres_url)
    run(["doctor", "--lang", "en"])
    assert re.search(r"the database server takes \d+ connections and has \d+", capsys.readouterr().out)
    run(["doctor", "--json"])
    assert json.loads(capsys.readouterr().out)["database_connections"].keys() == {"most", "taken"}
    nobody = make_url(postgres_url).set(host="127.0.0.1", port=1, query={}).render_as_string()
    monkeypatch.setenv("GRADER_DATABASE_URL", nobody)
    run(["doctor", "--json"])
    told = capsys.readouterr()
    assert "database_connections" not in json.loads(told.out)
    assert "does not answer" in told.err
