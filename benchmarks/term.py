"""A scripted term: a class of 300 from a messy workbook to the archive, over HTTP and on the pages, with times.

Every step of the instructor is done by `benchmarks.term_desks`, once over HTTP and once in Chromium, each in a
course of its own; only the first course is made on the server's command line. Students hand in over HTTP. The
first of their files are graded for real, the others get the result that their script has, by the queue's own
contract. At the end the pages of such a class are timed, cold and warm.

Usage: ``python -m benchmarks.term [--students 300] [--attempts 20] [--real 300] [--desks http,pages] [FOLDER]``
"""

from __future__ import annotations

import argparse
import asyncio
import hashlib
import io
import random
import re
import shutil
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager, nullcontext
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import httpx
import xlsxwriter
from python_calamine import CalamineWorkbook

from benchmarks.posting import Connections, prepared
from benchmarks.processes import Service, cpu_s
from benchmarks.term_desks import Desk, HttpDesk, PageDesk
from grader.catalog import Catalog, default_root
from grader.contracts.assignment import Assignment
from grader.contracts.grading import GradingJob, GradingResult
from grader.examination.zipped import packed
from grader.grading.slot import Slot, SlotConfig
from grader.store.clock import utc_now
from grader.store.database import Database
from grader.store.queue import Queue, Retries

SHIPPED = ("hello", "straight", "backward", "spin", "square", "triangle")
OWN = {"own_square": "square", "own_walk": "calculation"}
SECTIONS = ("A", "B", "C", "D", "E", "F")
ASSISTANTS = ("ta1", "ta2", "ta3", "ta4")
FIRST = "term-http"
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


@dataclass(slots=True)
class Steps:
    """What was done, and how long it took."""

    rows: list[tuple[str, str, float, str]] = field(default_factory=list)

    @contextmanager
    def step(self, desk: str, name: str) -> Iterator[Callable[[str], None]]:
        """Time a step; the function that is given notes what is worth telling of it."""
        said: list[str] = []
        started = time.monotonic()
        yield said.append
        self.rows.append((desk, name, time.monotonic() - started, "; ".join(said)))
        sys.stdout.write("| {} | {} | {:.1f} | {} |\n".format(*self.rows[-1]))
        sys.stdout.flush()


@dataclass(frozen=True, slots=True)
class Term:
    """What both desks' terms have in common."""

    service: Service
    folder: Path
    students: tuple[str, ...]
    works: Mapping[str, Sequence[Work]]
    zips: Mapping[str, bytes]
    attempts: int
    real: int
    steps: Steps


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
            assignment = catalog.get(name).of_course("humble")
            place = catalog.folder(name)
            suffix = "txt" if assignment.input == "text" else "py"
            paths = [place / f"solution.{suffix}", *sorted((place / "wrong").glob(f"*.{suffix}"))[:4]]
            for path in paths:
                source = path.read_bytes()
                if suffix == "py" and not _compiles(source):
                    continue
                job = GradingJob(file_name=path.name, source=source, assignment=assignment)
                found.setdefault(name, []).append(Work(name, path.name, source, slot.grade(job), assignment))
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


def hand_in(term: Term, tokens: Mapping[str, str], desk: str) -> list[str]:
    """Let everybody hand in over HTTP: some are graded for real, the others get what their script has."""
    plan = _plan(term)
    first, rest = plan[: term.real], plan[term.real :]
    with term.steps.step(desk, f"{len(first)} submissions handed in and graded for real"):
        submissions = asyncio.run(_post(term, tokens, first))
        _await_idle(term)
    term.service.restart({"SLOTS": "0"})
    with term.steps.step(desk, f"{len(rest)} submissions handed in over HTTP") as note:
        started = time.monotonic()
        submissions += asyncio.run(_post(term, tokens, rest))
        note(f"{len(rest) / (time.monotonic() - started):.0f}/s")
    with term.steps.step(desk, f"{len(rest)} results stored by the queue's contract") as note:
        note(f"{_inject(term)} claims")
    term.service.restart({"SLOTS": "2"})
    return submissions


def _plan(term: Term) -> list[tuple[str, Work, bytes]]:
    chance = random.Random(17)  # noqa: S311 - a class, no secret
    plan = []
    names = list(term.works)
    for attempt in range(term.attempts):
        assignment = names[attempt % len(names)]
        for student in chance.sample(term.students, len(term.students)):
            work = chance.choice(term.works[assignment])
            mark = f"\n# {student}, {attempt}\n" if work.name.endswith(".py") else "\n" * (attempt + 1)
            plan.append((student, work, work.source.rstrip() + mark.encode()))
    chance.shuffle(plan)
    return plan


async def _post(term: Term, tokens: Mapping[str, str], plan: Sequence[tuple[str, Work, bytes]]) -> list[str]:
    gate, url = asyncio.Semaphore(_AT_ONCE), term.service.urls[0]
    alone: dict[str, asyncio.Lock] = defaultdict(asyncio.Lock)

    async def send(connections: Connections, student: str, work: Work, content: bytes) -> str:
        headers = {"Authorization": f"Bearer {tokens[student]}"}
        form = {"assignment": work.assignment}
        post = prepared(url, "/api/v1/submissions", headers, form, (work.name, content))
        async with alone[student], gate:
            answer = await connections.send(post)
        assert answer.status == 202, answer.body
        return answer.body.decode()

    async with Connections() as connections:
        return await asyncio.gather(*(send(connections, *one) for one in plan))


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


def do_term(term: Term, desk: Desk, name: str, http: HttpDesk) -> str:
    """Do a whole term at a desk; return the token of the next term's instructor."""
    step, students = term.steps.step, term.students
    roster = term.folder / "roster.xlsx"
    messy_roster(roster, students)
    with step(name, "class list imported from a messy .xlsx") as note:
        note(desk.import_roster(roster))
    with step(name, "4 assistants added, each bound to a section"):
        for person, section in zip(ASSISTANTS, SECTIONS, strict=False):
            desk.add_assistant(person, section)
    with step(name, "tokens for everybody") as note:
        tokens = desk.make_tokens([*students, *ASSISTANTS])
        note(f"{len(tokens)} tokens")
    with step(name, "2 assignments of the course's own uploaded, a broken one refused") as note:
        broken = own_files("own_square")
        broken["assignment.yaml"] = broken["assignment.yaml"].replace(b"    points:", b"    pionts:", 1)
        note(f"broken at {desk.upload_broken(packed('own_square', broken))}")
        for content in term.zips.values():
            desk.upload(content)
    with step(name, "their scripts run by the service"):
        desk.await_ready(list(OWN))
    due = datetime.now(UTC) + timedelta(days=1)
    with step(name, "8 assignments published with dates, the others hidden"):
        desk.publish([*SHIPPED, *OWN], due, due + timedelta(days=30))
    with step(name, "late rules of 6 sections"):
        for i, section in enumerate(SECTIONS):
            desk.set_section(_LATE, section, due - timedelta(days=2 + i), _PER_DAY_PERCENT)
    hand_in(term, tokens, name)
    return after_handing_in(term, desk, name, http, tokens)


def after_handing_in(term: Term, desk: Desk, name: str, http: HttpDesk, tokens: Mapping[str, str]) -> str:
    """Do the rest of a term; return the token of the next term's instructor."""
    step, students, sheet = term.steps.step, term.students, term.folder / "sheet.xlsx"
    teachers_sheet(sheet, students[:-4])
    with step(name, f"{_APPEALS} appeals made by students (HTTP)"):
        appeals = make_appeals(term, http, tokens)
    with step(name, f"{_APPEALS} appeals answered"):
        for i, (submission, item, points) in enumerate(appeals):
            desk.answer_appeal(submission, item, _DECISIONS[i % len(_DECISIONS)], points)
    with step(name, "own assignment uploaded with a changed rubric, its scripts run"):
        desk.upload(packed("own_square", stricter(own_files("own_square"))))
        desk.await_ready(["own_square"])
    with step(name, "everybody's latest graded again on trial (real gradings)") as note:
        regrade = desk.regrade("own_square")
        note(f"{len(students)} gradings")
    with step(name, "the re-grade applied, then undone as a whole"):
        desk.apply_and_undo(regrade)
    with step(name, "3 people removed"):
        for one in students[-4:-1]:
            desk.remove(one)
    with step(name, "1 student forgotten"):
        desk.forget(students[-1])
    with step(name, "points filled into the teacher's own sheet") as note:
        note(f"{_filled(desk.fill_sheet(sheet, '总评'))} rows filled")
    with step(name, "everything downloaded") as note:
        note(f"{desk.download(term.folder) / 1e6:.1f} MB")
    return next_term(term, desk, name)


def next_term(term: Term, desk: Desk, name: str) -> str:
    """Archive the course and copy it; return the token of the copy's instructor."""
    with term.steps.step(name, "course archived"):
        desk.archive()
    with term.steps.step(name, "copied to the next term") as note:
        token = desk.copy(f"{name}-next")
        fresh = HttpDesk(term.service.urls[0], token)
        own = fresh.client.get("/api/v1/course/assignments").json()["assignments"]
        assert {one["assignment"]: one["state"] for one in own} == dict.fromkeys(OWN, "ready"), own
        rules = fresh.client.get(f"/api/v1/assignments/{_LATE}/rules").json()["rules"]
        assert len(rules["by_section"]) == len(SECTIONS)
        note("with its own assignments and late rules")
    return token


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
    """Do the terms."""
    settings = {"SLOTS": "2", "REQUESTS_AT_ONCE": "100"}
    steps = Steps()
    students = tuple(f"2026{number:04d}" for number in range(1, arguments.students + 1))
    print("| desk | step | s | |\n|---|---|---|---|")
    with steps.step("-", "every script graded once, to know its result") as note:
        known = works(folder)
        note(f"{sum(map(len, known.values()))} scripts")
    zips = {name: packed(name, own_files(name)) for name in OWN}
    with Service(folder, settings=settings) as service:
        term = Term(service, folder, students, known, zips, arguments.attempts, arguments.real, steps)
        with steps.step("-", "the first course made on the server"):
            printed = service.command("course", "create", FIRST, "--instructor", "wang")
            token = _token_of(printed)
            service.restart(settings)
        http = HttpDesk(service.urls[0], token)
        if "pages" in arguments.desks:
            with steps.step("pages", "a course of its own, copied from the first (HTTP)"):
                other = http.copy("term-pages")
            with browser_of(service.urls[0], folder, other) as browser:
                downloads = folder / "downloads"
                downloads.mkdir()
                do_term(term, PageDesk(browser, downloads), "term-pages", HttpDesk(service.urls[0], other))
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
    parser.add_argument("--desks", type=lambda text: text.split(","), default=["pages", "http"])
    arguments = parser.parse_args()
    place = tempfile.TemporaryDirectory() if arguments.folder is None else nullcontext(arguments.folder)
    with place as folder:
        Path(folder).mkdir(parents=True, exist_ok=True)
        run(arguments, Path(folder))


if __name__ == "__main__":
    main()
