"""A scripted term: a class of 300 from a messy workbook to the archive, over HTTP and on the pages, with times.

Every step of the instructor is done by `lab.term_desks`, once over HTTP and once in Chromium, each in a
course of its own; only the first course is made on the server. Students hand in over HTTP, or at the
desk of the pages in windows of Chromium (`lab.term_students`). The first of their files are graded for
real, the others get the result that their script has, by the queue's own contract. At the end the pages of such
a class are timed, cold and warm. FOLDER keeps what was done in ``steps.jsonl``: the same command goes on there.

Usage: ``python -m lab.term [--students 300] [--attempts 20] [--real 300] [--windows 3] [--desks http,pages]
[FOLDER]``
"""

from __future__ import annotations

import argparse
import asyncio
import hashlib
import io
import json
import random
import re
import shutil
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager, nullcontext
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta
from functools import partial
from pathlib import Path
from typing import Any

import httpx
import xlsxwriter
from python_calamine import CalamineWorkbook

from benchmarks.posting import Connections, prepared
from benchmarks.processes import Service, cpu_s
from grader.catalog import Catalog, default_root
from grader.contracts.assignment import Assignment
from grader.contracts.grading import GradingJob, GradingResult
from grader.grading.examination.zipped import packed
from grader.grading.slot import Slot, SlotConfig
from grader.store.clock import utc_now
from grader.store.database import Database
from grader.store.queue import Queue, Retries
from lab.term_desks import Desk, HttpDesk, PageDesk
from lab.term_students import Handed, Upload, hand_in_on_pages

SHIPPED = ("hello", "straight", "backward", "spin", "square", "triangle")
OWN = {"own_square": "square", "own_walk": "calculation"}
SECTIONS = ("A", "B", "C", "D", "E", "F")
ASSISTANTS = ("ta1", "ta2", "ta3", "ta4")
FIRST, PAGES = "term-http", "term-pages"
_APPEALS = 40
_AT_ONCE = 8
_PER_DAY_PERCENT = 10
_LATE = "square"
_WAIT_S = 1_800.0
_DECISIONS = ("answered", "corrected", "refused", "answered")
_TIMED = 5
_PREPARED_S = 3.0  # after a start the service prepares its pages by itself
_SURNAMES, _GIVEN = "赵钱孙李周吴郑王冯陈褚卫", ("伟", "芳", "娜", "敏", "静", "丽", "强", "磊", "军", "洋")


@dataclass(frozen=True, slots=True)
class Work:
    """A script of an assignment, and what it earns."""

    assignment: str
    name: str
    source: bytes
    result: GradingResult
    graded_by: Assignment


@dataclass(frozen=True, slots=True)
class Planned:
    """What a student will hand in. `number` is its place in the plan of the class."""

    number: int
    student: str
    work: Work
    content: bytes


Note = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class Steps:
    """What was done, what came of it and how long it took, in a file: after a restart it is not done again."""

    path: Path

    def do(self, desk: str, name: str, act: Callable[[Note], Any]) -> Any:
        """Do a step and time it, unless it was done before; return what it gave, which JSON can hold.

        The function that `act` is given notes what is worth telling of the step.
        """
        for line in self.path.read_text().splitlines() if self.path.exists() else ():
            known = json.loads(line)
            if (known["desk"], known["step"]) == (desk, name):
                return known["gave"]
        said: list[str] = []
        started = time.monotonic()
        gave = act(said.append)
        took = time.monotonic() - started
        row = {"desk": desk, "step": name, "s": round(took, 1), "told": "; ".join(said), "gave": gave}
        with self.path.open("a") as log:
            log.write(json.dumps(row, ensure_ascii=False) + "\n")
        sys.stdout.write(f"| {desk} | {name} | {took:.1f} | {row['told']} |\n")
        sys.stdout.flush()
        return gave


@dataclass(frozen=True, slots=True)
class Term:
    """What both desks' terms have in common. `windows`: of Chromium for students; 0: they use the interface."""

    service: Service
    folder: Path
    students: tuple[str, ...]
    works: Mapping[str, Sequence[Work]]
    zips: Mapping[str, bytes]
    attempts: int
    real: int
    windows: int
    steps: Steps

    def do(self, desk: str, name: str, act: Callable[[Note], Any]) -> Any:
        """Do a step once (`Steps.do`)."""
        return self.steps.do(desk, name, act)


def own_files(assignment: str) -> dict[str, bytes]:
    """Return the files of one of the course's own assignments: a shipped one under another id."""
    root = default_root() / OWN[assignment]
    files = {str(one.relative_to(root)): one.read_bytes() for one in root.rglob("*") if one.is_file()}
    files = {name: content for name, content in files.items() if "__pycache__" not in name}
    spec = files["assignment.yaml"].replace(
        f"id: {OWN[assignment]}".encode(), f"id: {assignment}".encode(), 1
    )
    return {**files, "assignment.yaml": spec}


def stricter(files: Mapping[str, bytes]) -> dict[str, bytes]:
    """Return the next version of the own square: sides may differ less."""
    spec = files["assignment.yaml"].decode()
    spec = re.sub(r"(?m)^version: (\d+)", lambda found: f"version: {int(found[1]) + 1}", spec)
    spec, count = re.subn(r"(measure: side_spread_pct\n    high: \S+\n    ramp: )(\S+)", _half, spec)
    assert count == 1
    return {**files, "assignment.yaml": spec.encode()}


def _half(found: re.Match[str]) -> str:
    return f"{found[1]}{float(found[2]) * 0.9:g}"


def works(folder: Path) -> dict[str, list[Work]]:
    """Grade every script once; return them by assignment."""
    for name in OWN:
        for file, content in own_files(name).items():
            path = folder / "own" / name / file
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
    catalogs = {**dict.fromkeys(SHIPPED, Catalog()), **dict.fromkeys(OWN, Catalog(folder / "own"))}
    found: dict[str, list[Work]] = {}
    with Slot(SlotConfig()) as slot:
        for name, catalog in catalogs.items():
            assignment = catalog.get(name).of_course("humble", None)
            (right, solution), _, *wrong = catalog.scripts(name).items()
            for script, source in [(right, solution), *sorted(wrong)[:4]]:
                if assignment.input == "script" and not _compiles(source):
                    continue
                file = script.removeprefix("wrong/")
                job = GradingJob(file_name=file, source=source, assignment=assignment)
                found.setdefault(name, []).append(Work(name, file, source, slot.grade(job), assignment))
    return found


def _compiles(source: bytes) -> bool:
    try:
        compile(source, "x", "exec")
    except (SyntaxError, ValueError):
        return False
    return True


def messy_roster(path: Path, students: Sequence[str]) -> None:
    """Write a registry's workbook: titles, a hidden sheet, ids as numbers, doubles, a sum, spaces."""
    with xlsxwriter.Workbook(path) as book:
        hidden = book.add_worksheet("参数")
        hidden.write_row(0, 0, ["学号", "姓名"])
        hidden.hide()
        sheet = book.add_worksheet("点名册")
        book.get_worksheet_by_name("点名册").activate()
        sheet.write(0, 0, "某大学 2026-2027 学年 课程点名册")
        sheet.write(1, 0, "课程：ROS 2 入门    教师：王")
        sheet.write_row(3, 0, ["序号", "学号", "姓名", "班级", "电子邮箱", "备注"])
        row = 4
        for i, one in enumerate(students):
            id_: Any = int(one) if i % 3 else one
            name = f"{_SURNAMES[i % 12]}{_GIVEN[i % 10]}{_GIVEN[i // 12 % 10] if i % 2 else ''}"
            mail = f"{one}@example.edu" if i % 4 else ""
            sheet.write_row(
                row, 0, [i + 1, id_, f" {name} ", SECTIONS[i % 6], mail, "" if i % 50 else "重修"]
            )
            row += 1
        sheet.write_row(row, 0, [len(students) + 1, students[0], "重复的行", "A"])
        sheet.write_row(row + 1, 0, [len(students) + 2, "", "没有学号", "B"])
        sheet.write_row(row + 2, 0, ["合计", len(students)])


def teachers_sheet(path: Path, students: Sequence[str]) -> None:
    """Write a sheet of the teacher's own, with a column to be filled."""
    with xlsxwriter.Workbook(path) as book:
        sheet = book.add_worksheet("成绩")
        sheet.write_row(0, 0, ["学号", "姓名", "平时成绩", "总评"])
        for row, one in enumerate(students, 1):
            sheet.write_row(row, 0, [int(one), "", "", ""])


def hand_in(term: Term, tokens: Mapping[str, str], desk: str) -> None:
    """Let everybody hand in: some are graded for real, the others get what their script has.

    At the desk of the pages students hand in on the pages, too, if there are windows for them.
    """
    plan = _plan(term)
    first, rest = plan[: term.real], plan[term.real :]
    how = "on the pages" if _on_pages(term, desk) else "over HTTP"

    def graded(note: Note) -> None:
        _send(term, tokens, first, desk, note)
        _await_idle(term)

    def sent(note: Note) -> None:
        term.service.restart({"SLOTS": "0"})
        _send(term, tokens, rest, desk, note)

    def stored(note: Note) -> None:
        note(f"{_inject(term)} claims")

    term.do(desk, f"{len(first)} submissions handed in {how} and graded for real", graded)
    term.do(desk, f"{len(rest)} submissions handed in {how}", sent)
    term.do(desk, f"{len(rest)} results stored by the queue's contract", stored)
    term.service.restart({"SLOTS": "2"})


def _on_pages(term: Term, desk: str) -> bool:
    return bool(term.windows) and desk == PAGES


def _send(term: Term, tokens: Mapping[str, str], plan: Sequence[Planned], desk: str, note: Note) -> None:
    started = time.monotonic()
    if _on_pages(term, desk):
        handed = Handed(term.folder / "handed.jsonl")
        before = len(handed.done)
        uploads = [
            Upload(one.number, one.student, one.work.assignment, one.work.name, one.content.decode())
            for one in plan
        ]
        hand_in_on_pages(term.service.urls[0], term.folder, tokens, uploads, handed, term.windows)
        sent = len(handed.done) - before
        note(handed.told())
        if sent:
            note(f"{handed.cpu_s / sent * 1000:.0f} ms of the browsers' processor time each")
    else:
        asyncio.run(_post(term, tokens, plan))
        sent = len(plan)
    if sent:
        note(f"{sent / (time.monotonic() - started):.1f}/s")


def _plan(term: Term) -> list[Planned]:
    chance = random.Random(17)  # noqa: S311 - a class, no secret
    plan: list[tuple[str, Work, bytes]] = []
    names = list(term.works)
    for attempt in range(term.attempts):
        assignment = names[attempt % len(names)]
        for student in chance.sample(term.students, len(term.students)):
            work = chance.choice(term.works[assignment])
            mark = f"\n# {student}, {attempt}\n" if work.name.endswith(".py") else "\n" * (attempt + 1)
            plan.append((student, work, work.source.rstrip() + mark.encode()))
    chance.shuffle(plan)
    return [Planned(number, *one) for number, one in enumerate(plan)]


async def _post(term: Term, tokens: Mapping[str, str], plan: Sequence[Planned]) -> None:
    gate, url = asyncio.Semaphore(_AT_ONCE), term.service.urls[0]
    alone: dict[str, asyncio.Lock] = defaultdict(asyncio.Lock)

    async def send(connections: Connections, one: Planned) -> None:
        headers = {"Authorization": f"Bearer {tokens[one.student]}"}
        form = {"assignment": one.work.assignment}
        post = prepared(url, "/api/v1/submissions", headers, form, (one.work.name, one.content))
        async with alone[one.student], gate:
            answer = await connections.send(post)
        assert answer.status in (200, 202), answer.body  # 200: it was there before an interruption

    async with Connections() as connections:
        await asyncio.gather(*(send(connections, one) for one in plan))


def _inject(term: Term) -> int:
    """Grade what waits as a worker does, but with results that are known already."""
    by_head = {(one.assignment, one.source.rstrip()): one for of in term.works.values() for one in of}
    done = 0
    with closing(Database(term.service.database)) as database:
        queue = Queue(database, utc_now, Retries())
        while (claim := queue.claim("term")) is not None:
            head = claim.source.rpartition(b"\n# ")[0] if b"\n# 2" in claim.source else claim.source
            work = by_head[claim.assignment, head.rstrip()]
            report = replace(work.result.report, submission_sha256=hashlib.sha256(claim.source).hexdigest())
            assert queue.finish(claim, replace(work.result, report=report), work.graded_by)
            done += 1
    return done


def _await_idle(term: Term) -> None:
    deadline = time.monotonic() + _WAIT_S
    with closing(Database(term.service.database)) as database:
        queue = Queue(database, utc_now, Retries())
        while (state := queue.state()).queued or state.running:
            if time.monotonic() > deadline:
                raise TimeoutError(f"{state.queued} still wait")
            time.sleep(0.5)


def make_appeals(term: Term, desk: HttpDesk, tokens: Mapping[str, str]) -> list[tuple[str, str, float]]:
    """Let students ask for another look at an item that lost points; return submission, item and its points."""
    made: list[tuple[str, str, float]] = []
    page = desk.client.get("/api/v1/submissions", params={"assignment": _LATE, "limit": 500}).json()
    for one in page["submissions"]:
        student, url = one["student"], f"/api/v1/submissions/{one['id']}"
        if len(made) == _APPEALS or student in term.students[-4:]:  # the last ones leave
            continue
        shown = desk.client.get(url).json()
        lost = [item for item in shown["rubric"] if item["earned"] < item["points"]]
        if not lost:
            continue
        headers = {"Authorization": f"Bearer {tokens[student]}"}
        body = {"item": lost[0]["id"], "reason": "Please look at the replay again."}
        answer = httpx.post(
            f"{term.service.urls[0]}{url}/appeals", json=body, headers=headers, trust_env=False
        )
        if answer.status_code == 201:
            made.append((one["id"], lost[0]["id"], lost[0]["points"]))
    assert made
    return made


def do_term(term: Term, desk: Desk, name: str, http: HttpDesk) -> None:
    """Do a whole term at a desk, or what is left of it."""
    do, students = partial(term.do, name), term.students
    roster = term.folder / "roster.xlsx"
    messy_roster(roster, students)
    do("class list imported from a messy .xlsx", lambda note: note(desk.import_roster(roster)))
    for person, section in zip(ASSISTANTS, SECTIONS, strict=False):
        do(f"assistant {person} added, bound to a section", lambda _: desk.add_assistant(person, section))  # noqa: B023
    tokens = do("tokens for everybody", lambda _: desk.make_tokens([*students, *ASSISTANTS]))

    def upload(note: Note) -> None:
        broken = own_files("own_square")
        broken["assignment.yaml"] = broken["assignment.yaml"].replace(b"    points:", b"    pionts:", 1)
        note(f"broken at {desk.upload_broken(packed('own_square', broken))}")
        for content in term.zips.values():
            desk.upload(content)

    do("2 assignments of the course's own uploaded, a broken one refused", upload)
    do("their scripts run by the service", lambda _: desk.await_ready(list(OWN)))
    due = datetime.now(UTC) + timedelta(days=1)
    do(
        "8 assignments published with dates, the others hidden",
        lambda _: desk.publish([*SHIPPED, *OWN], due, due + timedelta(days=30)),
    )
    for i, section in enumerate(SECTIONS):
        at = due - timedelta(days=2 + i)
        do(
            f"late rule of section {section}",
            lambda _: desk.set_section(_LATE, section, at, _PER_DAY_PERCENT),  # noqa: B023
        )
    hand_in(term, tokens, name)
    after_handing_in(term, desk, name, http, tokens)


def after_handing_in(term: Term, desk: Desk, name: str, http: HttpDesk, tokens: Mapping[str, str]) -> None:
    """Do the rest of a term, or what is left of it."""
    do, students, sheet = partial(term.do, name), term.students, term.folder / "sheet.xlsx"
    teachers_sheet(sheet, students[:-4])
    appeals = do(f"{_APPEALS} appeals made by students (HTTP)", lambda _: make_appeals(term, http, tokens))
    for i, (submission, item, points) in enumerate(appeals):
        decision = _DECISIONS[i % len(_DECISIONS)]
        do(f"appeal {i + 1} {decision}", lambda _: desk.answer_appeal(submission, item, decision, points))  # noqa: B023

    def change_rubric(_: Note) -> None:
        desk.upload(packed("own_square", stricter(own_files("own_square"))))
        desk.await_ready(["own_square"])

    do("own assignment uploaded with a changed rubric, its scripts run", change_rubric)
    regrade = do(
        "everybody's latest graded again on trial (real gradings)", lambda _: desk.regrade("own_square")
    )
    do("the re-grade applied, then undone as a whole", lambda _: desk.apply_and_undo(regrade))
    for one in students[-4:-1]:
        do(f"{one} removed", lambda _: desk.remove(one))  # noqa: B023
    do("1 student forgotten", lambda _: desk.forget(students[-1]))
    do(
        "points filled into the teacher's own sheet",
        lambda note: note(f"{_filled(desk.fill_sheet(sheet, '总评'))} rows filled"),
    )
    do("everything downloaded", lambda note: note(f"{desk.download(term.folder) / 1e6:.1f} MB"))
    do("course archived", lambda _: desk.archive())
    token = do("copied to the next term", lambda _: desk.copy(f"{name}-next"))
    do("the copy has its own assignments and late rules", lambda _: _check_copy(term, token))


def _check_copy(term: Term, token: str) -> None:
    fresh = HttpDesk(term.service.urls[0], token)
    own = fresh.client.get("/api/v1/course/assignments").json()["assignments"]
    assert {one["assignment"]: one["state"] for one in own} == dict.fromkeys(OWN, "ready"), own
    rules = fresh.client.get(f"/api/v1/assignments/{_LATE}/rules").json()["rules"]
    assert len(rules["by_section"]) == len(SECTIONS)


def _filled(content: bytes) -> int:
    rows = CalamineWorkbook.from_filelike(io.BytesIO(content)).get_sheet_by_index(0).to_python()
    column = rows[0].index("总评")
    return sum(isinstance(row[column], float) for row in rows[1:])


def time_pages(term: Term, token: str) -> None:
    """Print how long pages take, the first time after a start and then; and their processor time."""
    url = term.service.urls[0]
    with httpx.Client(base_url=url, timeout=60.0, trust_env=False) as client:
        sign_in(client, token)
        paths = pages_of(client)
        rows = []
        for path in paths:
            term.service.restart({"SLOTS": "0"})
            pid = term.service.running["api0"].pid
            client.get("/guide")  # what any page makes the process do for the first time
            time.sleep(_PREPARED_S)
            cold, cold_cpu = _timed(client, path, pid)
            warm = sorted(_timed(client, path, pid) for _ in range(_TIMED))
            rows.append((path, cold, cold_cpu, warm[_TIMED // 2][0], min(cpu for _, cpu in warm)))
    term.service.restart({"SLOTS": "2"})
    print("\n| page | cold, ms | its processor time | warm, ms | its processor time |")
    print("|---|---|---|---|---|")
    for path, *numbers in rows:
        print(f"| {path} |" + "".join(f" {one * 1000:.0f} |" for one in numbers))


def sign_in(client: httpx.Client, token: str) -> None:
    """Open a session of the pages."""
    form = re.search(r'name="form_token" value="([^"]+)"', client.get("/enter").text)
    assert form is not None
    answer = client.post("/enter", data={"form_token": form[1], "token": token})
    assert answer.status_code == 303, answer.status_code


def pages_of(client: httpx.Client) -> list[str]:
    """Return the pages of a class that an instructor looks at, with one student and submission as example."""
    html = client.get("/class").text
    student = re.search(r"/class/students/(\d+)", html)
    assert student is not None
    one = client.get(f"/class/students/{student[1]}").text
    submission = re.search(r"/submissions/([0-9a-f-]{36})", one)
    assert submission is not None
    regrade = re.search(r"/class/regrades/(\w+)", client.get("/class/regrades").text)
    return [
        "/", "/class", "/class?show=at_risk", "/class?section=A&sort=total&descending=true", "/class/gradebook",
        f"/class/assignments/{_LATE}", f"/class/assignments/{_LATE}/students?status=crashed",
        f"/class/students/{student[1]}", f"/submissions/{submission[1]}", "/class/judgements", "/class/appeals",
        "/class/regrades", *([f"/class/regrades/{regrade[1]}"] if regrade else []), "/class/rules",
        f"/class/rules/{_LATE}", "/class/own", "/class/people", f"/class/people/{student[1]}", "/class/course",
        "/class/audit", "/class/service",
    ]  # fmt: skip


def _timed(client: httpx.Client, path: str, pid: int) -> tuple[float, float]:
    before, started = cpu_s(pid), time.perf_counter()
    answer = client.get(path)
    took = time.perf_counter() - started
    assert answer.status_code in (200, 422), (path, answer.status_code)
    return took, cpu_s(pid) - before


@contextmanager
def browser_of(address: str, folder: Path, token: str) -> Iterator[Any]:
    """Yield a Chromium that is signed in."""
    from tests.e2e.chromium import DESKTOP, chromium

    programs = shutil.which("chromium"), shutil.which("chromedriver")
    assert all(programs), "chromium and chromedriver are needed"
    with chromium(programs, folder / "profile", address) as browser:  # type: ignore[arg-type]
        browser.open("/enter")
        browser.signed_in("token", token)
        browser.resize(DESKTOP)
        yield browser


def run(arguments: argparse.Namespace, folder: Path) -> None:
    """Do the terms, or what is left of them."""
    settings = {"SLOTS": "2", "REQUESTS_AT_ONCE": "100"}
    steps = Steps(folder / "steps.jsonl")
    students = tuple(f"2026{number:04d}" for number in range(1, arguments.students + 1))
    print("| desk | step | s | |\n|---|---|---|---|")
    known = works(folder)
    zips = {name: packed(name, own_files(name)) for name in OWN}
    with Service(folder, settings=settings) as service:
        term = Term(
            service,
            folder,
            students,
            known,
            zips,
            arguments.attempts,
            arguments.real,
            arguments.windows,
            steps,
        )
        made = partial(service.command, "course", "create", FIRST, "--instructor", "wang")
        token = term.do("-", "the first course made on the server", lambda _: _token_of(made()))
        service.restart(settings)
        http = HttpDesk(service.urls[0], token)
        if "pages" in arguments.desks:
            other = term.do("-", "a second course, copied from the first (HTTP)", lambda _: http.copy(PAGES))
            downloads = folder / "downloads"
            downloads.mkdir(exist_ok=True)
            with browser_of(service.urls[0], folder, other) as browser:
                do_term(term, PageDesk(browser, downloads), PAGES, HttpDesk(service.urls[0], other))
            token_of_class = other
        if "http" in arguments.desks:
            do_term(term, http, FIRST, http)
            token_of_class = token
        time_pages(term, token_of_class)


def _token_of(printed: str) -> str:
    found = re.search(r"grader_[\w-]+", printed)
    assert found is not None, printed
    return found[0]


def main() -> None:
    """Read the arguments and do the terms."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", nargs="?", type=Path)
    parser.add_argument("--students", type=int, default=300)
    parser.add_argument("--attempts", type=int, default=20, help="submissions of each student")
    parser.add_argument("--real", type=int, default=300, help="submissions that are graded for real")
    parser.add_argument("--windows", type=int, default=3, help="of Chromium for students; 0: HTTP")
    parser.add_argument("--desks", type=lambda text: text.split(","), default=["pages", "http"])
    arguments = parser.parse_args()
    place = tempfile.TemporaryDirectory() if arguments.folder is None else nullcontext(arguments.folder)
    with place as folder:
        Path(folder).mkdir(parents=True, exist_ok=True)
        run(arguments, Path(folder))


if __name__ == "__main__":
    main()
