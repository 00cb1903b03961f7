"""A class hands in while processes are killed, stopped, frozen: is anything lost, graded twice, scored otherwise?

By default on PostgreSQL with 2 API processes and 3 workers; with ``--database embedded`` one process on SQLite
does everything. Clients send again, under the same idempotency key, what got no answer. The gradebook must equal
an independent recomputation from what each script earns without the service, and, with ``--reference``, byte for
byte that of an undisturbed run (``--faults none --gradebook FILE``) of the same seed.

Exit code 1 if anything is wrong. Run it on loopback only; each process's output is kept if something was.
"""

from __future__ import annotations

import argparse
import asyncio
import shutil
import statistics
import sys
import tempfile
import time
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

import httpx
from rich.console import Console
from rich.table import Table
from sqlalchemy import text

from benchmarks import gradebook
from benchmarks.classroom import Upload, graded_scripts, plan, roster
from benchmarks.faults import KINDS, Fault, Faults
from benchmarks.handing_in import HandingIn, Sent, steady
from benchmarks.postgres_server import PostgresServer
from benchmarks.processes import INSTRUCTOR, Service
from grader.store.database import Database

_LOOK_S = 1.0
_SUBMISSIONS_EACH = 4  # of a student, about, when nobody says how many students there are


@dataclass(frozen=True, slots=True)
class Ended:
    """What the database says when everything is over. Instants by submission, in seconds since 1970."""

    finished: dict[str, float]
    states: dict[str, str]
    gradings: dict[str, int]
    attempts: dict[str, int]


def main() -> int:
    """Run, print what was seen, return the exit code."""
    options = _options()
    console = Console()
    kinds = [] if options.faults == "none" else options.faults.split(",")
    students = roster(options.students or max(1, options.submissions // _SUBMISSIONS_EACH))
    every = plan(graded_scripts(), students, 3, options.seed)
    uploads = [one for one in every if one.kind == "fresh"]
    random_order = uploads[:: max(1, len(uploads) // options.submissions)][: options.submissions]
    with ExitStack() as stack:
        server = stack.enter_context(PostgresServer()) if options.database == "postgres" else None
        folder = Path(tempfile.mkdtemp(prefix="grader-chaos-"))
        service = stack.enter_context(
            Service(
                folder,
                apis=options.apis,
                workers=options.workers,
                database=None if server is None else server.url,
            )
        )
        run = _Run(console, service, options.patience_s)
        tokens = service.enrol(students)
        headers = {"Authorization": f"Bearer {tokens[INSTRUCTOR]}"}
        with httpx.Client(base_url=service.urls[0], headers=headers, timeout=60.0, trust_env=False) as client:
            gradebook.set_rules(client, students)
            faults = Faults(service, kinds, options.every_s, options.seed, server)
            handing_in = HandingIn(service.urls, tokens, insist=True)
            at_s = steady(len(random_order), options.per_second, options.seed)
            run.disturbed(faults, handing_in, random_order, at_s)
            failed = run.judged(client, faults.made, handing_in.sent, students, options)
    if not failed:
        shutil.rmtree(folder)
    else:
        console.print(f"what the processes said: {folder}")
    return int(failed)


class _Run:
    """One run: hands in under faults, waits until all is graded, and judges."""

    def __init__(self, console: Console, service: Service, patience_s: float) -> None:
        self._console = console
        self._service = service
        self._patience_s = patience_s

    def disturbed(
        self, faults: Faults, handing_in: HandingIn, uploads: Sequence[Upload], at_s: Sequence[float]
    ) -> None:
        """Hand everything in while faults are made, and wait until nothing is open any more."""
        started = time.monotonic()
        faults.start()
        asyncio.run(handing_in.run(uploads, at_s))
        handed_in_s = time.monotonic() - started
        faults.stop()
        stopped_s = time.monotonic() - started
        deadline = time.monotonic() + self._patience_s
        while self._open() and time.monotonic() < deadline:
            faults.supervise()
            time.sleep(_LOOK_S)
        self._console.print(
            f"handed in for {handed_in_s:.0f} s; all settled {time.monotonic() - started - stopped_s:.0f} s after "
            f"the last fault; {len(faults.made)} faults"
        )

    def judged(
        self,
        client: httpx.Client,
        faults: Sequence[Fault],
        sent: Sequence[Sent],
        students: Sequence[str],
        options: argparse.Namespace,
    ) -> bool:
        """Print the verdict; return whether anything is wrong."""
        accepted = [one for one in sent if one.accepted]
        ids = {one.location.rpartition("/")[2] for one in accepted}
        ended = self._ended()
        lost = [id_ for id_ in ids if ended.states.get(id_) != "graded"]
        twice = [id_ for id_, count in ended.gradings.items() if count > 1]
        again = sum(attempt > 1 for attempt in ended.attempts.values())
        answer = client.get("/api/v1/gradebook.csv").raise_for_status()
        wanted = gradebook.expected(
            [one.upload for one in sorted(accepted, key=lambda one: one.order)], students
        )
        right = gradebook.read(answer.text) == wanted
        same = options.reference is None or options.reference.read_bytes() == answer.content
        if options.gradebook is not None:
            options.gradebook.write_bytes(answer.content)
        self._console.print(
            f"sent {len(sent)}, accepted {len(accepted)}, rows {len(ended.states)}, lost {len(lost)}, "
            f"graded twice in effect {len(twice)}; claimed more than once {again}"
        )
        self._console.print(
            f"gradebook {'equals' if right else 'DIFFERS FROM'} the independent recomputation"
        )
        if options.reference is not None:
            self._console.print(
                f"gradebook {'equals' if same else 'DIFFERS FROM'} that of the undisturbed run"
            )
        self._recoveries(faults, ended)
        return bool(lost or twice or len(ended.states) != len(ids) or not right or not same)

    def _recoveries(self, faults: Sequence[Fault], ended: Ended) -> None:
        """Print how long it took from a fault until what it hit was graded, and until anything was."""
        table = Table(title="seconds from a fault", title_justify="left")
        headings = ("fault", "how often", "its gradings", "graded after: median", "max", "next grading: max")
        for heading in headings:
            table.add_column(heading, justify="left" if heading == "fault" else "right")
        if not faults:
            return
        instants = sorted(ended.finished.values())
        for kind in dict.fromkeys(fault.kind for fault in faults):
            own = [fault for fault in faults if fault.kind == kind]
            after = [
                ended.finished[id_] - fault.at.timestamp()
                for fault in own
                for id_ in fault.struck
                if ended.finished.get(id_, 0.0) > fault.at.timestamp()  # else it was done just before
            ]
            gaps = [
                next((one - fault.at.timestamp() for one in instants if one > fault.at.timestamp()), 0.0)
                for fault in own
            ]
            told = (f"{statistics.median(after):.1f}", f"{max(after):.1f}") if after else ("", "")
            table.add_row(kind, str(len(own)), str(len(after)), *told, f"{max(gaps):.1f}")
        self._console.print(table)

    def _open(self) -> int:
        return sum(state in ("queued", "running") for state in self._ended().states.values())

    def _ended(self) -> Ended:
        database = Database(self._service.database)
        try:
            with database.reading() as session:
                rows = session.execute(text("SELECT id, state, attempt, finished_at FROM submission")).all()
                counts = session.execute(
                    text("SELECT submission_id, count(*) FROM grading GROUP BY submission_id")
                ).all()
        finally:
            database.close()
        return Ended(
            finished={row[0]: _instant(row[3]) for row in rows if row[3] is not None},
            states={row[0]: row[1] for row in rows},
            gradings={row[0]: row[1] for row in counts},
            attempts={row[0]: row[2] for row in rows},
        )


def _instant(value: datetime | str) -> float:
    """Return an instant as SQLite or PostgreSQL hand it out, in seconds since 1970."""
    instant = datetime.fromisoformat(value) if isinstance(value, str) else value
    return (instant if instant.tzinfo else instant.replace(tzinfo=UTC)).timestamp()


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.chaos", description=__doc__)
    parser.add_argument("--database", choices=("embedded", "postgres"), default="postgres")
    parser.add_argument("--submissions", type=int, default=100)
    parser.add_argument(
        "--students", type=int, help="how many hand in; 300 and 6,300 submissions: `load class`"
    )
    parser.add_argument("--per-second", type=float, default=3.0, help="uploads in a second")
    parser.add_argument("--faults", default=",".join(KINDS), help=f"some of {','.join(KINDS)}, or none")
    parser.add_argument("--every-s", type=float, default=4.0, help="seconds between faults, on average")
    parser.add_argument("--apis", type=int, help="processes of `grader serve`")
    parser.add_argument("--workers", type=int, help="processes of `grader worker`; 0: in the API process")
    parser.add_argument("--seed", type=int, default=7)
    parser.add_argument("--gradebook", type=Path, metavar="FILE", help="write the gradebook there")
    parser.add_argument("--reference", type=Path, metavar="FILE", help="an undisturbed run's gradebook")
    parser.add_argument("--patience-s", type=float, default=300.0, help="how long to wait in the end")
    options = parser.parse_args()
    scaled = options.database == "postgres"
    options.apis = options.apis or (2 if scaled else 1)
    options.workers = (3 if scaled else 0) if options.workers is None else options.workers
    unknown = set(options.faults.split(",")) - {*KINDS, "none"}
    if unknown:
        parser.error(f"unknown faults: {', '.join(sorted(unknown))}")
    return options


if __name__ == "__main__":
    sys.exit(main())
