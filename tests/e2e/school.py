"""The real service with a course in it: people, rules, right and wrong scripts, an essay that waits for a person.

In this process, so that the assignments are copies that can be changed; grading is real.
"""

import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import httpx
import pytest

from grader.api import create_app
from grader.catalog import Catalog, default_root
from grader.commands.demo import await_grades
from grader.contracts.identity import Role, RosterEntry
from grader.contracts.rules import LateRule, Rules
from grader.operation.settings import Settings
from grader.render.terminal import console
from grader.service.composition import running, running_worker
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.fakes import server

COURSE = "ros2-2026"
PEOPLE = {
    "20260101": ("李雷", Role.STUDENT),
    "20260102": ("韩梅梅", Role.STUDENT),
    "20260103": ("欧阳娜娜", Role.STUDENT),
    "20260104": ("Jim Green", Role.STUDENT),
    "20260105": ("王小明", Role.STUDENT),
    "zhang": ("助教小张", Role.ASSISTANT),
    "wang": ("王老师", Role.INSTRUCTOR),
}
ASSIGNMENTS = ("hello", "straight", "spin", "square", "square_input", "theory_publisher_timer")
SQUARE, ESSAY = "square", "theory_publisher_timer"
WORK = (  # who hands in what; the last of the roster hands in nothing
    ("20260101", "hello", "solution.py"),
    ("20260101", "straight", "solution.py"),
    ("20260101", SQUARE, "wrong/one_radian.py"),
    ("20260101", SQUARE, "solution.py"),
    ("20260101", ESSAY, "solution.txt"),
    ("20260102", "hello", "wrong/warn_level.py"),
    ("20260102", SQUARE, "wrong/last_side_short.py"),
    ("20260102", "square_input", "solution.py"),
    ("20260103", SQUARE, "wrong/one_radian.py"),
    ("20260103", SQUARE, "wrong/five_sides.py"),
    ("20260103", SQUARE, "wrong/never_stops.py"),
    ("20260103", ESSAY, "solution.txt"),
    ("20260104", "spin", "solution.py"),
    ("20260104", SQUARE, "wrong/arcs.py"),
)


@dataclass(frozen=True)
class School:
    """A running course. `tokens` by person; `files`: its assignments; `submitted`: ids of what was handed in."""

    services: Services
    address: str
    tokens: dict[str, str]
    files: Path
    submitted: tuple[str, ...] = ()

    def client(self, person: str) -> httpx.Client:
        """Return a client of the interface that is signed in."""
        headers = {"Authorization": f"Bearer {self.tokens[person]}"}
        return httpx.Client(base_url=self.address, headers=headers, timeout=60.0, trust_env=False)

    def tighten(self) -> None:
        """Let unequal sides of the square lose all their credit soon: one tolerance less, in the next version."""
        path = self.files / SQUARE / "assignment.yaml"
        text = path.read_text(encoding="utf-8")
        text, count = re.subn(r"(measure: side_spread_pct\n    high: \S+\n    ramp: )\S+", r"\g<1>2", text)
        assert count == 1
        path.write_text(
            re.sub(r"(?m)^version: (\d+)", lambda at: f"version: {int(at[1]) + 1}", text), "utf-8"
        )


@contextmanager
def school(
    url: str,
    folder: Path,
    work: tuple[tuple[str, str, str], ...] = WORK,
    *,
    websockets: bool = False,
    signin: Path | None = None,
    more: tuple[str, ...] = (),
) -> Iterator[School]:
    """Open a course in the database at `url`, let everybody hand in their `work` and grade it.

    Its assignments, and `more`, are copied to `folder`. `signin`: the file of accounts from elsewhere.
    """
    files = folder / "assignments"
    for name in (*ASSIGNMENTS, *more):
        shutil.copytree(default_root() / name, files / Path(name).name)
    # 600: one student's in all tests of a module
    settings = Settings(database_url=url, practice_per_minute=600, signin=signin, slots=0)
    grading = Settings(database_url=url, poll_s=0.02)  # here, because another process would not be patched
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("grader.catalog.default_root", lambda: files)
        patch.setattr("grader.catalog.refreshed._FRESH_S", 0.0)  # an edited assignment is seen at once
        with (
            running(settings) as services,
            running_worker(grading),
            server.serving(create_app(lambda: nullcontext(services)), websockets=websockets) as client,
        ):
            opened = School(services, str(client.base_url).rstrip("/"), _enrol(services), files)
            yield replace(opened, submitted=_hand_in(opened, work))


def _enrol(services: Services) -> dict[str, str]:
    services.courses.create(COURSE, "ROS 2 入门", "Asia/Shanghai", "setup")
    roster = [RosterEntry(id=one, name=name, role=role) for one, (name, role) in PEOPLE.items()]
    services.courses.import_roster(COURSE, roster, "setup")
    due = datetime.now(UTC).replace(hour=15, minute=59, second=0, microsecond=0) + timedelta(days=14)
    rules = Rules(due=due, late=LateRule(kind="linear", per_day=0.1), attempts=5)
    services.rules.set(SQUARE, rules, Signature(services.clock(), COURSE, "wang"), "开学")
    return {one: services.tokens.issue(COURSE, one, timedelta(days=1), "setup")[1] for one in PEOPLE}


def _hand_in(opened: School, work: tuple[tuple[str, str, str], ...]) -> tuple[str, ...]:
    locations = []
    for student, assignment, file in work:
        source = Catalog(opened.files).scripts(assignment)[file]
        with opened.client(student) as client:
            answer = client.post(
                "/api/v1/submissions",
                data={"assignment": assignment},
                files={"file": (file.removeprefix("wrong/"), source)},
            )
            locations.append(str(answer.raise_for_status().headers["Location"]))
    with opened.client("wang") as client:
        await_grades(client, locations, console())
    return tuple(one.rpartition("/")[2] for one in locations)
