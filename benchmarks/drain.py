"""What the service adds to a grading, and how long accepting an upload takes the store.

Rounds alternate between two bare grading loops and the service with two slots, over the same scripts: a round's
submissions are queued in one transaction, and its time goes from the first claim to the last result. Nothing is
uploaded meanwhile. So a busy machine slows both, and nothing but claiming, handing over and storing differs.

Then the call that stores and queues an upload is timed: while nothing is graded, and while both slots grade.
"""

from __future__ import annotations

import argparse
import os
import statistics
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from itertools import count, islice
from pathlib import Path

from rich.console import Console
from rich.table import Table
from sqlalchemy import func, select
from sqlmodel import col

from benchmarks.classroom import Upload, plan, roster, scripts
from benchmarks.load import milliseconds
from benchmarks.postgres_server import PostgresServer
from benchmarks.processes import Service, Spent, spent
from grader.catalog import Catalog
from grader.contracts.grading import GradingJob
from grader.contracts.identity import Role, RosterEntry
from grader.contracts.submission import NewSubmission, SubmissionState
from grader.grading.slot import Slot, SlotConfig
from grader.service.composition import GRADING_NICENESS
from grader.store.clock import Clock, clock_of
from grader.store.courses import Courses
from grader.store.database import Database
from grader.store.intake import Intake, take_in
from grader.store.schema import migrate
from grader.store.tables import SubmissionRow

_COURSE = "ros2-load"
_SLOTS = 2
_STUDENTS = 300
# so many that each connection has stored every assignment once, and each form of statement is compiled
_WARM_UP = 200
_LOOK_S = 0.5  # seldom: what watches must not cost what is measured
_POLL_S = "0.02"  # on SQLite, what another process queued is found by looking
_QUEUED_AHEAD = 60
_UPLOADS_PER_SECOND = 20.0
# as the service has it, so that what else runs slows both the same
_ISOLATION = SlotConfig(niceness=GRADING_NICENESS)


@dataclass(frozen=True, slots=True)
class Round:
    """So many gradings in so much time."""

    gradings: int
    took_s: float
    spent: Spent


class BareLoops:
    """Grading processes that are given one job after the other, and nothing else."""

    def __init__(self, slots: Sequence[Slot]) -> None:
        """Drive `slots`, each from a thread of its own."""
        self._slots = slots

    def run(self, uploads: Sequence[Upload]) -> Round:
        """Grade `uploads`."""
        jobs = iter([bare_job(one) for one in uploads])
        lock = threading.Lock()

        def loop(slot: Slot) -> None:
            while True:
                with lock:
                    job = next(jobs, None)
                if job is None:
                    return
                slot.grade(job)

        threads = [threading.Thread(target=loop, args=(slot,)) for slot in self._slots]
        before, started = spent([os.getpid()]), time.perf_counter()
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        return Round(len(uploads), time.perf_counter() - started, spent([os.getpid()]).since(before))


class Drain:
    """A service that is given submissions behind the back of its HTTP interface."""

    def __init__(self, database: Database, clock: Clock, service: Service, server: int | None) -> None:
        """Drive what `service` has started on `database`, which is of the server `server`."""
        self._database = database
        self._clock = clock
        self._service = service
        self._server = server
        self._intake = Intake(database)

    def run(self, uploads: Sequence[Upload]) -> Round:
        """Queue `uploads` at one instant and wait until they are graded."""
        before = self._spent()
        ids = self.queue(uploads)
        self.await_empty()
        after = self._spent()
        row = SubmissionRow
        times = select(func.min(col(row.started_at)), func.max(col(row.finished_at))).where(
            col(row.id).in_(ids)
        )
        with self._database.reading() as session:
            first, last = session.execute(times).one()
        return Round(len(ids), (last - first).total_seconds(), after.since(before))

    def queue(self, uploads: Sequence[Upload]) -> list[str]:
        """Store and queue `uploads` in one transaction; return their ids."""
        now = self._clock()
        with self._database.writing() as session:
            return [take_in(session, self.new(one), now)[0].id for one in uploads]

    def await_empty(self) -> None:
        """Wait until nothing waits and nothing is graded."""
        states = (SubmissionState.QUEUED.value, SubmissionState.RUNNING.value)
        open_ = select(col(SubmissionRow.id)).where(col(SubmissionRow.state).in_(states)).limit(1)
        while True:
            with self._database.reading() as session:
                if session.execute(open_).first() is None:
                    return
            time.sleep(_LOOK_S)

    def accept(self, uploads: Sequence[Upload], every_s: float) -> list[float]:
        """Store and queue `uploads` one by one, at intervals; return how long each took, in seconds."""
        times = []
        begun = time.perf_counter()
        for number, one in enumerate(uploads):
            time.sleep(max(0.0, begun + number * every_s - time.perf_counter()))
            upload = self.new(one)
            started = time.perf_counter()
            self._intake.accept(upload, self._clock())
            times.append(time.perf_counter() - started)
        return times

    def new(self, upload: Upload) -> NewSubmission:
        """Return an upload as the HTTP interface hands it to the store."""
        return NewSubmission(
            course=_COURSE,
            student=upload.student,
            assignment=upload.script.assignment,
            file_name=upload.script.name,
            source=upload.content,
            ruled=True,
            assignment_version=1,
        )

    def _spent(self) -> Spent:
        return spent([process.pid for process in self._service.running.values()], self._server)


def bare_job(upload: Upload) -> GradingJob:
    """Return an upload as a grading process is told it."""
    assignment = Catalog().get(upload.script.assignment)
    return GradingJob(file_name=upload.script.name, source=upload.content, assignment=assignment)


def main() -> None:
    """Measure and print."""
    options = _options()
    console = Console()
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="grader-drain-")))
        server = stack.enter_context(PostgresServer()) if options.database == "postgres" else None
        # two workers of one slot each; the embedded default is one process with both slots
        service = Service(
            folder,
            apis=0 if server else 1,
            workers=_SLOTS if server else 0,
            database=server.url if server else None,
            settings={"SLOTS": str(_SLOTS)} | ({} if server else {"POLL_S": _POLL_S}),
        )
        database = Database(service.database)
        stack.callback(database.close)
        migrate(database)
        clock = stack.enter_context(clock_of(database))
        _enrol(database, clock)
        drain = Drain(database, clock, service, server.pid if server else None)
        uploads = _uploads(options.seed)
        idle = drain.accept(list(islice(uploads, options.accept)), 1 / _UPLOADS_PER_SECOND)
        stack.enter_context(service)
        drain.await_empty()
        slots = [stack.enter_context(Slot(_ISOLATION)) for _ in range(_SLOTS)]
        rounds = _rounds(options.gradings, options.rounds, uploads, BareLoops(slots), drain)
        report(console, rounds)
        drain.queue(list(islice(uploads, _QUEUED_AHEAD)))
        busy = drain.accept(list(islice(uploads, options.accept)), 1 / _UPLOADS_PER_SECOND)
        drain.await_empty()
    console.print(f"an upload stored and queued while nothing is graded: {milliseconds(idle)}")
    console.print(f"an upload stored and queued while both slots grade: {milliseconds(busy)}")


def _rounds(
    gradings: int, rounds: int, uploads: Iterator[Upload], bare: BareLoops, drain: Drain
) -> list[tuple[Round, Round]]:
    first = list(islice(uploads, _WARM_UP))
    bare.run(first)
    drain.run(first)
    chunks = [list(islice(uploads, gradings // rounds)) for _ in range(rounds)]
    return [(bare.run(chunk), drain.run(chunk)) for chunk in chunks]


def report(console: Console, rounds: Sequence[tuple[Round, Round]]) -> None:
    """Print rates, their ratio, and where the processors' time went."""
    gradings = sum(bare.gradings for bare, _ in rounds)
    ratios = [bare.took_s / service.took_s for bare, service in rounds]
    table = Table(title=f"{gradings} gradings, each, in {len(rounds)} rounds; ms of processor time a grading")
    for heading in ("", "gradings/s", "parent", "grading process", "scripts", "database", "all"):
        table.add_column(heading, justify="right")
    for name, each in zip(("bare loops", "service"), zip(*rounds, strict=True), strict=True):
        used = Spent(0.0, 0.0, 0.0)
        for one in each:
            used = used.plus(one.spent)
        kinds = (used.parent, used.grading, used.scripts, used.database)
        costs = [f"{kind / gradings * 1e3:.1f}" for kind in (*kinds, sum(kinds))]
        table.add_row(name, f"{gradings / sum(one.took_s for one in each):.1f}", *costs)
    console.print(table)
    whole = sum(bare.took_s for bare, _ in rounds) / sum(service.took_s for _, service in rounds)
    console.print(
        f"service / bare loops: {whole:.3f} (median round {statistics.median(ratios):.3f}); "
        f"load of the last minute {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores"
    )


def _uploads(seed: int) -> Iterator[Upload]:
    """Yield a class's work over and over, no two files the same."""
    files, students = list(scripts()), roster(_STUDENTS)
    for turn in count():
        for one in plan(files, students, 3, seed + turn):
            if one.kind == "fresh":
                yield Upload(one.student, one.attempt + turn * 10, one.script)


def _enrol(database: Database, clock: Clock) -> None:
    courses = Courses(database, clock)
    courses.create(_COURSE, _COURSE, "Asia/Shanghai", "benchmark")
    people = [RosterEntry(id=one, name=one, role=Role.STUDENT) for one in roster(_STUDENTS)]
    courses.import_roster(_COURSE, people, "benchmark")


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.drain", description=__doc__)
    parser.add_argument("--database", choices=("postgres", "embedded"), default="postgres")
    parser.add_argument("--gradings", type=int, default=400)
    parser.add_argument("--rounds", type=int, default=8)
    parser.add_argument("--accept", type=int, default=200, help="uploads to time, each time")
    parser.add_argument("--seed", type=int, default=7)
    return parser.parse_args()


if __name__ == "__main__":
    main()
