"""Grading again with everything real: a trial after one tolerance was tightened.

On SQLite; `test_browser_course` does the same on PostgreSQL, through the pages.
"""

import time
from pathlib import Path

from grader.catalog import Catalog
from grader.contracts.grading import GradingJob
from grader.grading.slot import Slot
from tests.e2e.school import SQUARE, school

WORK = (
    ("20260101", SQUARE, "solution.py"),
    ("20260102", SQUARE, "solution.py"),
    ("20260102", SQUARE, "wrong/last_side_short.py"),
    ("20260103", SQUARE, "wrong/last_side_short.py"),
    ("20260103", SQUARE, "wrong/one_radian.py"),
    ("20260104", SQUARE, "wrong/five_sides.py"),
    ("20260105", SQUARE, "wrong/never_stops.py"),
)


def scores(slot: Slot, files: Path) -> dict[str, float | None]:
    """Return what each student's latest script earns under the assignment as it is now, by the core alone."""
    assignment = Catalog(files).get(SQUARE)
    scripts = Catalog(files).scripts(SQUARE)
    latest = {student: scripts[file] for student, _, file in WORK}
    return {
        student: slot.grade(GradingJob(file_name="a.py", source=source, assignment=assignment)).report.score
        for student, source in latest.items()
    }


def test_a_trial_after_tightening_one_tolerance_lists_exactly_those_it_hits(
    sqlite_url: str, tmp_path: Path, slot: Slot
) -> None:
    with school(sqlite_url, tmp_path, WORK) as course, course.client("wang") as wang:
        before = scores(slot, course.files)
        course.tighten()
        after = scores(slot, course.files)
        started = wang.post("/api/v1/regrades", json={"assignment": SQUARE, "which": "latest"})
        while (trial := wang.get(started.headers["Location"]).raise_for_status().json())["waiting"]:
            time.sleep(0.05)
    told = {one["student"]: (one["before"], one["after"]) for one in trial["changes"]}
    assert told == {
        student: (score, after[student]) for student, score in before.items() if score != after[student]
    }
    assert 0 < len(told) < len(before)
    assert trial["same"] == len(before) - len(told)
    assert {item["item"] for one in trial["changes"] for item in one["items"]} == {"lengths"}
