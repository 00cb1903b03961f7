"""What the gradebook must say, worked out anew: from what each script earns and the course's rules.

Nothing here uses the service's own code for rules, attempts or tables. Due dates lie days away from now, so that
what lateness costs does not depend on the minute of an upload.
"""

from __future__ import annotations

import csv
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from typing import Any, Literal

import httpx

from benchmarks.classroom import ASSIGNMENTS, Upload

_EXTENDED_EVERY = 5


@dataclass(frozen=True, slots=True)
class Rule:
    """A rule as the service is told it, and what it means for an upload made now.

    Attributes:
        keeps: share of its points that an upload keeps; `extended_keeps`: that of a student with an extension.
    """

    body: Mapping[str, Any]
    counts: Literal["best", "last"] = "best"
    keeps: float = 1.0
    extended_keeps: float = 1.0


def rules(now: datetime) -> dict[str, Rule]:
    """Return a rule of each kind that there is."""
    late = (now - timedelta(hours=36)).isoformat()
    tomorrow = (now + timedelta(days=1)).isoformat()
    steps = [{"after_s": 3_600, "keep": 0.9}, {"after_s": 86_400, "keep": 0.5}]
    per_day = {"kind": "linear", "per_day": 0.1}
    return {
        "straight": Rule({"counts": "last"}, counts="last"),
        "backward": Rule({"due": late, "late": per_day}, keeps=0.8, extended_keeps=0.8),
        "spin": Rule({"due": late, "late": {"kind": "steps", "steps": steps}}, keeps=0.5, extended_keeps=0.5),
        "triangle": Rule({"due": late, "late": per_day, "counts": "last"}, counts="last", keeps=0.8),
        "pentagon": Rule({"due": tomorrow, "counts": "best_before_due", "attempts": 50}),
    }


def is_extended(student: str) -> bool:
    """Whether a student has more time for the triangle."""
    return int(student) % _EXTENDED_EVERY == 0


def set_rules(teacher: httpx.Client, students: Sequence[str]) -> None:
    """Tell the service the rules and extensions."""
    now = datetime.now(UTC)
    for assignment, rule in rules(now).items():
        address = f"/api/v1/assignments/{assignment}/rules"
        teacher.put(address, json=dict(rule.body)).raise_for_status()
    more = {"due": (now + timedelta(days=2)).isoformat(), "reason": "ill"}
    for student in filter(is_extended, students):
        teacher.put(f"/api/v1/assignments/triangle/extensions/{student}", json=more).raise_for_status()


def expected(accepted: Iterable[Upload], students: Sequence[str]) -> list[dict[str, str]]:
    """Return the gradebook's lines after `accepted`, fresh uploads in order of arrival, were graded."""
    earned: dict[tuple[str, str], list[float]] = defaultdict(list)
    for upload in accepted:
        earned[upload.student, upload.script.assignment].append(upload.script.score)
    known = rules(datetime.now(UTC))
    lines = []
    for student in sorted(students):
        line, total = {"student": student}, 0.0
        for assignment in ASSIGNMENTS:
            scores = earned[student, assignment]
            points = _counted(scores, known.get(assignment, Rule({})), student)
            total += points or 0.0
            line[assignment] = "" if points is None else f"{points:g}"
            line[f"{assignment} attempts"] = str(len(scores))
        lines.append(line | {"total": f"{round(total, 2):g}"})
    return lines


def read(table: str) -> list[dict[str, str]]:
    """Return the lines of the service's CSV in the shape of `expected`."""
    wanted = {"student", "total", *ASSIGNMENTS, *(f"{one} attempts" for one in ASSIGNMENTS)}
    rows = csv.DictReader(table.removeprefix("\ufeff").splitlines())
    return [
        {name: value for full, value in row.items() if (name := full.partition(" (")[0]) in wanted}
        for row in rows
    ]


def _counted(scores: Sequence[float], rule: Rule, student: str) -> float | None:
    if not scores:
        return None
    keeps = rule.extended_keeps if is_extended(student) else rule.keeps
    kept = [round(score * keeps, 2) for score in scores]
    return kept[-1] if rule.counts == "last" else max(kept)
