"""Assignments that instructors upload to their course, over HTTP and with a worker's examiner."""

import json
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import httpx
import pytest
import yaml

from grader.catalog import Catalog, default_root
from grader.checks import evaluate_text
from grader.contracts.errors import InfrastructureError, RefusedError
from grader.contracts.grading import GradingJob, GradingResult
from grader.contracts.identity import Caller, Role
from grader.contracts.own_assignment import OwnState
from grader.contracts.record import from_json, to_plain
from grader.contracts.text import Text
from grader.formats.packages.bundle import bundled
from grader.grading.examination.confined import _read
from grader.grading.examination.reading import Reading
from grader.grading.examination.zipped import packed, unpacked
from grader.grading.slot import Slot
from grader.service.worker.examiner import Examiner, Uploads
from grader.store.audit import Signature
from grader.store.database import Database
from grader.store.own_assignments import OwnAssignments
from grader.use_cases import own_assignments
from grader.use_cases.course_assignments import CourseAssignments
from grader.use_cases.rubric_changes import NewItem, adopt_scores, change_rubric, is_changed, last_saved
from grader.use_cases.services import Services
from tests.fakes.clock import FakeClock
from tests.fakes.essays import grade_essay
from tests.fakes.grading import FakeAssignments, Lent, grade_next
from tests.fakes.packages import NAME, zipped

OWN = "/api/v1/course/assignments"
FOLDER = default_root() / "calculation"
FILES = {str(one.relative_to(FOLDER)): one.read_bytes() for one in FOLDER.rglob("*") if one.is_file()}
SPEC = (
    FILES["assignment.yaml"]
    .replace(b"id: calculation", b"id: walk")
    .replace(b"version: %d" % Catalog().get("calculation").version, b"version: 1")
)


def folder(spec: bytes = SPEC, **changed: bytes) -> bytes:
    named = {name.replace("__", "/").replace("_txt", ".txt"): content for name, content in changed.items()}
    return packed("walk", {**FILES, "assignment.yaml": spec, **named})


def grade(job: GradingJob) -> GradingResult:
    """Grade a text as the pipeline does."""
    result = grade_essay(job)
    verdict = evaluate_text(job.assignment, job.source.decode())
    return replace(result, report=replace(result.report, mistakes=verdict.mistakes))


class TextGrader:
    """Grades in this process; fails as often as told."""

    def __init__(self) -> None:
        self.faults = 0
        self.graded = 0

    def grade(self, job: GradingJob, on_run: Callable[[], None] = lambda: None) -> GradingResult:
        if self.faults:
            self.faults -= 1
            raise InfrastructureError("no room")
        self.graded += 1
        return grade(job)

    def start(self) -> None:
        pass

    abort = close = start


class Desk:
    """An instructor's requests, and a worker that examines when the test says so."""

    def __init__(self, client: httpx.Client, school: Any, services: Services, examiner: Examiner) -> None:
        self.client, self.school, self.services, self.examiner = client, school, services, examiner

    def upload(self, content: bytes, person: str = "wang", language: str = "en") -> httpx.Response:
        headers = {**self.school.as_(person), "Accept-Language": language}
        return self.client.post(OWN, files={"file": ("walk.zip", content)}, headers=headers)

    def listed(self, person: str = "wang") -> list[dict[str, Any]]:
        answer = self.client.get(OWN, headers=self.school.as_(person))
        found: list[dict[str, Any]] = answer.json()["assignments"]
        return found

    def checklist(self, person: str) -> list[str]:
        answer = self.client.get("/api/v1/assignments", headers=self.school.as_(person)).json()
        return [one["id"] for one in answer["assignments"]]

    def publish(self) -> None:
        url, wang = "/api/v1/assignments/walk/rules", self.school.as_("wang")
        tag = self.client.get(url, headers=wang).headers["ETag"]
        answer = self.client.put(url, json={"shown": "always"}, headers={**wang, "If-Match": tag})
        assert answer.status_code == 200, answer.text


@pytest.fixture
def grader() -> TextGrader:
    return TextGrader()


@pytest.fixture
def confined() -> None:
    """For a test whose folders are read by a process of their own, as in service."""


@pytest.fixture(autouse=True)
def read_here(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Read the folders of all other tests in this process: starting one takes longer than the rest of a test."""

    def answer(folder: Path) -> Reading:
        return from_json(Reading, json.dumps(_read(folder), default=to_plain))

    if "confined" not in request.fixturenames:
        monkeypatch.setattr("grader.grading.examination.reading._answer", answer)


@pytest.fixture
def desk(
    client: httpx.Client,
    school: Any,
    services: Services,
    grader: TextGrader,
    clock: FakeClock,
    sqlite_url: str,
) -> Iterator[Desk]:
    with closing(Database(sqlite_url)) as database:
        own = OwnAssignments(database, clock)
        known = CourseAssignments(FakeAssignments(), own, lambda: clock().timestamp())
        made = replace(services, assignments=known)
        examiner = Examiner(
            Uploads(own=own, make_grader=lambda: grader),
            known,
            ready=lambda: True,
            students_wait=lambda: False,
        )
        yield Desk(client, school, made, examiner)


@pytest.fixture(autouse=True)
def served(running: Any, desk: Desk) -> None:
    running[0].state.services = desk.services


@pytest.mark.usefixtures("confined")
def test_from_a_zip_to_a_student(desk: Desk, upload: Callable[..., httpx.Response]) -> None:
    answer = desk.upload(folder())
    assert (answer.status_code, answer.json()["state"]) == (202, "waiting")
    assert desk.checklist("wang") == ["straight", "square"]
    assert desk.examiner.step()
    assert not desk.examiner.step()
    (ready,) = desk.listed()
    assert (ready["state"], ready["version"], ready["uploaded_by"]) == ("ready", 1, "wang")
    wrong = [one for one in FILES if one.startswith("wrong/")]
    own = ("solution.txt", "starter.txt", *wrong)
    assert {one["script"]: one["problem"] for one in ready["scripts"]} == dict.fromkeys(own, "")
    assert desk.checklist("wang") == ["straight", "square", "walk"]  # for the staff to try
    assert desk.checklist("li") == ["straight", "square"]
    desk.publish()
    assert desk.checklist("li") == ["straight", "square", "walk"]
    assert desk.checklist("li2") == ["straight", "square"]  # of another course
    response = upload(b"12 s\n", "walk", "", "calculation.txt", headers=desk.school.as_("li"))
    assert response.status_code == 202, response.text
    assert grade_next(desk.services.queue, desk.services.assignments, grade)
    report = desk.client.get(response.headers["Location"], headers=desk.school.as_("li")).json()
    assert report["score"] == 100.0


@pytest.mark.usefixtures("confined")
def test_a_package_is_asked_for_examined_and_graded(
    desk: Desk, slot: Slot, grader: TextGrader, upload: Callable[..., httpx.Response]
) -> None:
    """Solution, starter and wrong ones as folders, one of them zipped as a student would."""
    made = default_root() / "make_package"
    files = {str(one.relative_to(made)): one.read_bytes() for one in made.rglob("*") if one.is_file()}
    spec = files.pop("assignment.yaml").replace(b"id: make_package", b"id: walk")
    spec = b"".join(line for line in spec.splitlines(True) if b"wrong" in line or b"file:" not in line)
    spec += b"  - {file: no_init.zip, score: [32, 32], fails: modules, mistake: package_no_init}\n"
    kept = {name: text for name, text in files.items() if name.split("/")[0] in ("solution", "starter")}
    bad = {name[14:]: text for name, text in files.items() if name.startswith("wrong/no_init/")}
    kept["wrong/no_init.zip"] = zipped({f"build/{NAME}/x.py": "1", **bad})
    assert desk.upload(packed("walk", {**kept, "assignment.yaml": spec})).status_code == 202
    lent = Lent(slot)
    grader.grade = lent.grade  # type: ignore[method-assign]
    assert desk.examiner.step()
    (ready,) = desk.listed()
    scores = {one["script"]: (one["score"], one["problem"]) for one in ready["scripts"]}
    assert scores["wrong/no_init.zip"] == (32.0, "")
    assert scores["solution.zip"] == (100.0, "")
    assert ready["state"] == "ready"
    desk.publish()
    handed_in = zipped(
        {name.removeprefix("solution/"): text for name, text in kept.items() if name.startswith("solution/")}
    )
    response = upload(handed_in, "walk", "", "my_package.zip", headers=desk.school.as_("li"))
    assert response.status_code == 202, response.text
    assert grade_next(desk.services.queue, desk.services.assignments, lent.grade)
    report = desk.client.get(response.headers["Location"], headers=desk.school.as_("li")).json()
    assert report["score"] == 100.0
    assert bundled(handed_in) in desk.services.assignments.of("ros").given_code()


@pytest.mark.usefixtures("confined")
def test_an_attempt_that_is_a_change_is_examined_as_the_script_that_it_makes(desk: Desk) -> None:
    change = b'{file: changed.txt, change: {"= 12 s": "= 9 s", "12 \xe7\xa7\x92": "9 s"}, '
    spec = SPEC.replace(b"{file: area.txt, ", change)
    assert spec != SPEC
    assert desk.upload(folder(spec)).status_code == 202
    assert desk.examiner.step()
    (ready,) = desk.listed()
    scores = {one["script"]: (one["score"], one["problem"]) for one in ready["scripts"]}
    assert scores["wrong/changed.txt"] == (20.0, "")
    answer = desk.upload(folder(spec.replace(b"= 12 s", b"= 13 s")))
    assert answer.status_code == 422
    assert "wrong.1.change: what is changed does not have '= 13 s'" in answer.text


@pytest.mark.usefixtures("confined")
def test_what_is_wrong_is_told_by_file_line_and_field(desk: Desk) -> None:
    spec = SPEC.replace(b"points: 80", b"points: many")
    answer = desk.upload(folder(spec))
    problem = answer.json()
    line = spec.decode().split("points: many")[0].count("\n") + 1
    assert (answer.status_code, problem["code"]) == (422, "invalid_assignment")
    assert problem["errors"][0]["field"] == f"assignment.yaml:{line}: items.0.points"
    assert desk.upload(b"no zip", language="zh").json()["detail"].startswith("zip: 这不是 zip 文件")
    assert desk.listed() == []


def test_a_script_that_does_not_get_what_it_must_keeps_the_assignment_away(
    desk: Desk, clock: FakeClock
) -> None:
    desk.upload(folder(wrong__area_txt=b"12 s\n"))
    assert desk.examiner.step()
    clock.advance(3)
    (refused,) = desk.listed()
    assert refused["state"] == "refused"
    bad = [one for one in refused["scripts"] if one["problem"]]
    assert [(one["script"], one["score"]) for one in bad] == [("wrong/area.txt", 100.0)]
    assert desk.checklist("wang") == ["straight", "square"]
    desk.upload(folder())
    assert desk.examiner.step()
    assert [one["state"] for one in desk.listed()] == ["ready"]  # the refused one is not kept


def test_how_far_an_examination_is_can_be_seen(
    desk: Desk, grader: TextGrader, monkeypatch: pytest.MonkeyPatch
) -> None:
    progress: list[tuple[int, int]] = []

    def graded(job: GradingJob, on_run: Callable[[], None] = lambda: None) -> GradingResult:
        [one] = desk.listed()
        progress.append((one["begun"], one["in_all"]))
        return grade(job)

    monkeypatch.setattr(grader, "grade", graded)
    desk.upload(folder())
    assert desk.examiner.step()
    scripts = len(progress)
    assert progress == [(number, scripts) for number in range(1, scripts + 1)]
    assert [(one["begun"], one["in_all"], len(one["scripts"])) for one in desk.listed()] == [(0, 0, scripts)]


def test_a_rubric_changes_with_its_version_only(desk: Desk, clock: FakeClock) -> None:
    desk.upload(folder())
    desk.examiner.step()
    clock.advance(3)
    changed = SPEC.replace(b"points: 80", b"points: 70").replace(b"points: 20", b"points: 30")
    problem = desk.upload(folder(changed)).json()
    assert problem["errors"][0]["field"] == "assignment.yaml: version"
    assert "items.answer.points, items.unit.points changed" in problem["errors"][0]["detail"]
    raised = changed.replace(b"version: 1", b"version: 2")
    for low, high in ((b"[20, 20]", b"[30, 30]"), (b"[80, 80]", b"[70, 70]")):
        raised = raised.replace(low, high)
    assert desk.upload(folder(raised)).status_code == 202
    assert [(one["version"], one["state"]) for one in desk.listed()] == [(1, "ready"), (2, "waiting")]
    assert desk.services.assignments.of("ros").get("walk").version == 1
    desk.examiner.step()
    clock.advance(3)
    assert [(one["version"], one["state"]) for one in desk.listed()] == [(2, "ready")]
    assert desk.services.assignments.of("ros").get("walk").version == 2


def test_each_course_has_its_own(desk: Desk, clock: FakeClock) -> None:
    other = SPEC.replace(b"points: 80", b"points: 60").replace(b"points: 20", b"points: 40")
    other = other.replace(b"[20, 20]", b"[40, 40]").replace(b"[80, 80]", b"[60, 60]")
    desk.upload(folder())
    assert desk.upload(folder(other), "zhao").status_code == 202
    while desk.examiner.step():
        pass
    clock.advance(3)
    items = [desk.services.assignments.of(one).get("walk").items[0].points for one in ("ros", "other")]
    assert items == [80.0, 60.0]


def test_what_is_stored_can_be_downloaded_and_removed(
    desk: Desk, upload: Callable[..., httpx.Response], clock: FakeClock
) -> None:
    desk.upload(folder())
    desk.examiner.step()
    clock.advance(3)
    wang = desk.school.as_("wang")
    assert desk.client.get(f"{OWN}/walk/folder.zip", headers=wang).content == folder()
    upload(b"12 s\n", "walk", "", "calculation.txt", headers=wang)
    answer = desk.client.delete(f"{OWN}/walk", headers=wang)
    assert (answer.status_code, answer.json()["code"]) == (409, "assignment_in_use")
    desk.upload(folder(SPEC.replace(b"id: walk", b"id: run")))
    assert desk.client.delete(f"{OWN}/run", headers=wang).status_code == 204
    assert [one["assignment"] for one in desk.listed()] == ["walk"]
    actions = [one.action for one in desk.services.audit.entries("ros", 5)]
    assert actions[0] == "assignment.remove"
    assert "assignment.upload" in actions


def test_what_another_machine_removed_takes_nothing_in(
    desk: Desk, upload: Callable[..., httpx.Response], clock: FakeClock
) -> None:
    desk.upload(folder())
    desk.examiner.step()
    desk.listed()
    assert "walk" in desk.checklist("wang")
    desk.services.own_assignments.remove("walk", Signature(clock(), "ros", "wang"))
    assert "walk" in desk.checklist("wang")  # for half a second
    answer = upload(b"12 s\n", "walk", "", "calculation.txt", headers=desk.school.as_("wang"))
    assert (answer.status_code, answer.json()["code"]) == (422, "unknown_assignment")
    assert desk.client.get("/api/v1/submissions", headers=desk.school.as_("wang")).json()["submissions"] == []


def test_a_fault_of_the_service_refuses_nothing_at_first(
    desk: Desk, grader: TextGrader, clock: FakeClock
) -> None:
    desk.upload(folder())
    grader.faults = 1
    assert desk.examiner.step()
    (waiting,) = desk.listed()
    assert (waiting["state"], "no room" in waiting["trouble"]) == ("waiting", True)
    assert not desk.examiner.step()  # not at once
    clock.advance(60)
    assert desk.examiner.step()
    assert desk.listed()[0]["state"] == "ready"
    desk.upload(folder(SPEC.replace(b"version: 1", b"version: 2")))
    grader.faults = 100
    while desk.examiner.step():
        clock.advance(600)
    given_up = desk.listed()[-1]
    assert (given_up["state"], given_up["version"]) == ("refused", 2)
    assert (
        "could not run"
        in desk.client.get(OWN, headers={**desk.school.as_("wang"), "Accept-Language": "en"}).json()[
            "assignments"
        ][-1]["misfits"][0]["detail"]
    )


def test_a_copy_of_the_course_has_them_too(desk: Desk, clock: FakeClock) -> None:
    desk.upload(folder())
    desk.examiner.step()
    clock.advance(3)
    desk.publish()
    made = desk.client.post(
        "/api/v1/courses", json={"id": "next", "move_days": 364}, headers=desk.school.as_("wang")
    ).json()
    next_term = {"Authorization": f"Bearer {made['token']}"}
    listed = desk.client.get(OWN, headers=next_term).json()["assignments"]
    assert [(one["assignment"], one["state"]) for one in listed] == [("walk", "ready")]
    clock.advance(3)
    assert "walk" in [one.id for one in desk.services.assignments.of("next").all()]


def test_what_this_version_cannot_use_disables_only_itself(desk: Desk, clock: FakeClock) -> None:
    desk.upload(folder())
    own = desk.services.own_assignments
    claim = own.claim()
    assert claim is not None
    assert own.finish(claim, b"{}", ready=True, reading=b'{"assignment": {"id": "walk"}}')
    clock.advance(3)
    assert desk.checklist("wang") == ["straight", "square"]
    assert list(desk.services.assignments.of("ros").troubles()) == ["walk"]
    assert desk.services.assignments.of("other").troubles() == {}


def shares(desk: Desk) -> None:
    """Let every course have the assignment whose files these are."""
    shared = FakeAssignments()
    shared.assignments = (*shared.assignments, Catalog().get("calculation"))
    shared.files = lambda assignment_id: FILES  # type: ignore[method-assign]
    desk.services.assignments._shared = shared


INSTRUCTOR = Caller(person="wang", role=Role.INSTRUCTOR, course="ros")
BRIEF = Text(zh="算一算", en="Compute it")


def changes(points: tuple[float, float]) -> list[NewItem]:
    items = zip(Catalog().get("calculation").items, points, strict=True)
    return [
        NewItem(title=item.title, points=given, low=item.low, high=item.high, ramp=item.ramp)
        for item, given in items
    ]


def test_a_course_changes_the_rubric_of_a_shared_assignment_and_takes_that_back(
    desk: Desk, clock: FakeClock
) -> None:
    shares(desk)
    services = desk.services
    upload = change_rubric(services, INSTRUCTOR, "calculation", BRIEF, changes((60.0, 40.0)))
    assert (upload.version, upload.state) == (Catalog().get("calculation").version + 1, OwnState.WAITING)
    assert desk.examiner.step()
    clock.advance(3)

    assert [one.state for one in services.own_assignments.of("ros")] == [OwnState.READY]
    ours, theirs = (services.assignments.of(one).get("calculation") for one in ("ros", "other"))
    assert [item.points for item in ours.items] == [60.0, 40.0]
    assert ours.brief == BRIEF
    assert theirs == Catalog().get("calculation")
    assert [one.id for one in services.assignments.of("ros").all()].count("calculation") == 1
    assert "calculation" in desk.checklist("li")  # no draft: students had it before
    assert is_changed(services, INSTRUCTOR, ours)

    desk.upload(folder())
    own_assignments.remove(services, INSTRUCTOR, "calculation", "")
    clock.advance(3)
    assert services.assignments.of("ros").get("calculation") == theirs


def test_a_second_change_builds_on_the_first(desk: Desk, clock: FakeClock) -> None:
    shares(desk)
    for points in ((60.0, 40.0), (70.0, 30.0)):
        change_rubric(desk.services, INSTRUCTOR, "calculation", BRIEF, changes(points))
        desk.examiner.step()
        clock.advance(3)
    ours = desk.services.assignments.of("ros").get("calculation")
    assert ours.version == Catalog().get("calculation").version + 2
    assert [item.points for item in ours.items] == [70.0, 30.0]


def test_a_rubric_that_cannot_be_names_the_field(desk: Desk) -> None:
    shares(desk)
    with pytest.raises(RefusedError) as refused:
        change_rubric(desk.services, INSTRUCTOR, "calculation", BRIEF, changes((0.0, 100.0)))
    assert refused.value.code == "invalid_assignment"
    assert [one.field for one in refused.value.members["misfits"]] == ["items.0.points"]
    with pytest.raises(RefusedError) as short:
        change_rubric(desk.services, INSTRUCTOR, "calculation", BRIEF, changes((1.0, 2.0))[:1])
    assert short.value.code == "changed_meanwhile"


def test_the_scores_of_copied_wrong_scripts_are_adopted_after_other_points(
    desk: Desk, clock: FakeClock
) -> None:
    spec = SPEC.replace(b"points: 80", b"points: 50").replace(b"points: 20", b"points: 50")
    desk.upload(folder(spec))
    assert desk.examiner.step()
    clock.advance(3)
    (refused,) = desk.listed()
    bad = {one["script"]: one["score"] for one in refused["scripts"] if one["problem"]}
    assert refused["state"] == "refused"
    assert bad

    adopt_scores(desk.services, INSTRUCTOR, "walk")
    assert desk.examiner.step()
    clock.advance(3)
    (ready,) = desk.listed()
    assert (ready["state"], ready["version"]) == ("ready", 1)
    assert {one["script"]: one["score"] for one in ready["scripts"]}.items() >= bad.items()
    with pytest.raises(RefusedError, match="assignment_not_found"):
        adopt_scores(desk.services, INSTRUCTOR, "walk")


def test_full_marks_of_a_wrong_script_are_not_adopted(desk: Desk, clock: FakeClock) -> None:
    desk.upload(folder(wrong__area_txt=b"12 s\n"))
    desk.examiner.step()
    adopt_scores(desk.services, INSTRUCTOR, "walk")
    desk.examiner.step()
    clock.advance(3)
    assert [one["state"] for one in desk.listed()] == ["refused"]


def test_a_refused_rubric_is_there_to_be_gone_on_with(desk: Desk, clock: FakeClock) -> None:
    shares(desk)
    rubric = Catalog().get("calculation")
    assert last_saved(desk.services, INSTRUCTOR, rubric) is rubric
    change_rubric(desk.services, INSTRUCTOR, "calculation", BRIEF, changes((60.0, 40.0)))
    content = own_assignments.folder(desk.services, INSTRUCTOR, "calculation")
    files = {**unpacked(content), "wrong/area.txt": b"12 s\n"}
    own_assignments.upload(desk.services, INSTRUCTOR, packed("calculation", files))
    desk.examiner.step()
    clock.advance(3)
    assert desk.services.own_assignments.of("ros")[-1].state is OwnState.REFUSED
    saved = last_saved(desk.services, INSTRUCTOR, rubric)
    assert [item.points for item in saved.items] == [60.0, 40.0]


def test_a_changed_rubric_wants_no_mistake_of_the_old_bands(desk: Desk) -> None:
    shares(desk)
    change_rubric(desk.services, INSTRUCTOR, "calculation", BRIEF, changes((60.0, 40.0)))
    spec = yaml.safe_load(
        unpacked(own_assignments.folder(desk.services, INSTRUCTOR, "calculation"))["assignment.yaml"]
    )
    assert b"mistake:" in FILES["assignment.yaml"]
    assert [one for one in spec["wrong"] if "mistake" in one] == []
