"""What it costs to compare a class: scripts of 300 students for each of seven assignments, all of them different.

Every student's script is one of ours with code of their own; one in ten copies somebody else's. All recordings of
one script are the same. Prints processor time and elapsed time of the first look at all of it, and of the next.

Usage: ``python -m lab.similar_scripts FOLDER [STUDENTS]``; the folder gets a database of the class.
"""

from __future__ import annotations

import asyncio
import random
import resource
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from benchmarks.classroom import ASSIGNMENTS, Script, Upload, results, roster
from benchmarks.seeded_class import COURSE, seed
from grader.contracts.identity import Caller, Role
from grader.grading.practice import PracticeRuns
from grader.grading.preflight import NoPreflight
from grader.grading.slot import Slot, SlotConfig
from grader.live.cars import LiveCars
from grader.operation.settings import Settings
from grader.service.composition import assignments_of
from grader.store.clock import utc_now
from grader.store.courses import Courses
from grader.store.database import Database
from grader.store.queue import Retries
from grader.store.schema import migrate
from grader.store.tokens import Tokens
from grader.use_cases.callers import Callers
from grader.use_cases.pictures import PlotCache, draw_stored
from grader.use_cases.services import Services
from grader.use_cases.similar import similar

_TEACHER = Caller(course=COURSE, person="wang", role=Role.INSTRUCTOR)
_COPIES_ONE_IN = 10
_OWN_LINES = 12
_DEPTH = 4


def own_code(number: int) -> bytes:
    """Return a function that only this number has."""
    dice = random.Random(number)  # noqa: S311 - a class, no secret
    lines = "".join(f"    value = {_expression(dice, _DEPTH)}\n" for _ in range(_OWN_LINES))
    return f"\n\ndef own(a, b, f):\n{lines}".encode()


def _expression(dice: random.Random, depth: int) -> str:
    if depth == 0:
        return dice.choice(("a", "b", "3", "'c'", "f()", "None"))
    one, other = (_expression(dice, dice.randrange(depth)) for _ in range(2))
    operator = dice.choice(("+", "-", "*", "//", "%", "<<", "and", "or", "is", "<", "!="))
    return dice.choice((f"({one} {operator} {other})", f"f({one}, {other})", f"[{one}][{other}]"))


def handed_in(scripts: Sequence[Script], students: Sequence[str]) -> list[Upload]:
    """Return one script of each student for each of `ASSIGNMENTS`."""
    uploads = []
    for assignment in ASSIGNMENTS:
        ours = [one for one in scripts if one.assignment == assignment]
        for i, student in enumerate(students):
            author = i - 1 if i % _COPIES_ONE_IN == 1 else i
            chosen = ours[author % len(ours)]
            script = replace(chosen, source=chosen.source + own_code(author))
            uploads.append(Upload(student=student, attempt=1, script=script))
    return uploads


def measure(services: Services) -> None:
    """Look at every assignment twice and print what that took."""
    for look in ("first", "next"):
        before, started = resource.getrusage(resource.RUSAGE_SELF), time.perf_counter()
        found = [asyncio.run(similar(services, _TEACHER, one)) for one in ASSIGNMENTS]
        after, wall_s = resource.getrusage(resource.RUSAGE_SELF), time.perf_counter() - started
        cpu_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        compared, pairs = sum(one.compared for one in found), sum(len(one.pairs) for one in found)
        print(
            f"{look} look: {cpu_s:.2f} s of processor time, {wall_s:.2f} s; {compared} compared, {pairs} pairs"
        )
    print(f"most memory: {after.ru_maxrss // 1024} MiB")


def main() -> None:
    """Write a class and compare it."""
    folder, *rest = sys.argv[1:]
    settings = Settings(database_url=f"sqlite:///{Path(folder) / 'grader.db'}")
    database = Database(settings.database_url)
    migrate(database)
    graded = results()
    uploads = handed_in([script for script, _ in graded], roster(int(rest[0]) if rest else 300))
    seed(
        database,
        sorted({one.student for one in uploads}),
        uploads,
        {(one.assignment, one.name): result for one, result in graded},
    )
    services = Services.over(
        database,
        settings,
        utc_now,
        retries=Retries(lease_s=60.0, max_tries=3, backoff_s=1.0),
        assignments=assignments_of(settings, database, utc_now),
        preflight=NoPreflight(),
        plots=PlotCache(draw_stored, 1),
        callers=Callers(Courses(database, utc_now), Tokens(database, utc_now), "unused", utc_now),
        live=LiveCars(0),
        practice=PracticeRuns(0, lambda: Slot(SlotConfig()), lambda: False),
    )
    measure(services)
    services.comparer.close()
    services.space.close()
    services.plots.close()
    services.watching.close()
    database.close()


if __name__ == "__main__":
    main()
