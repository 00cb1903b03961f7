"""Which notices a course should get now: its present state is compared with what earlier notices reported.

A group learns no names and nobody's points. Of graded work it learns only how much there is.
"""

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime, time, timedelta
from typing import Final
from zoneinfo import ZoneInfo

from grader.contracts.assignment import Assignment
from grader.contracts.dashboard import StudentProgress
from grader.contracts.identity import Member, Role
from grader.contracts.notation import written
from grader.contracts.notice import Draft, MailWishes, NoticeKind, Outlet
from grader.contracts.submission import SubmissionState
from grader.contracts.text import Language
from grader.messages import on_page
from grader.store.rules import CourseRules
from grader.use_cases.services import Services

_DUE_FROM: Final = time(9)
"""The hour, on the course's clock, of reminders on the day before an assignment is due."""

_GRADED_AT: Final = time(18)
"""The hour of a group's daily notice of how much was graded since the day before."""

_GRADED_UNTIL = timedelta(hours=6)
_GATHERED = timedelta(minutes=30)
"""Shortest time between two notices about gradings or faults; what happens meanwhile is put into one."""

_LOOKED_BACK = timedelta(days=7)
_STALLED = timedelta(minutes=15)
_NEEDED = timedelta(days=2)
_MOST_LINES = 20
_A_SECOND = timedelta(seconds=1)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Look:
    """A course at one instant."""

    services: Services
    course: str
    title: str
    now: datetime
    rules: CourseRules
    students: Sequence[Member]
    instructors: Sequence[Member]
    assignments: Mapping[str, Assignment]
    progress: Mapping[tuple[str, str], StudentProgress]

    @property
    def zone(self) -> ZoneInfo:
        return self.rules.zone

    @property
    def language(self) -> Language:
        return self.services.settings.default_language

    def titled(self, assignment: str) -> str:
        """Return what people call an assignment."""
        one = self.assignments.get(assignment)
        return assignment if one is None else one.title.get(self.language)

    def local(self, instant: datetime) -> str:
        """Return an instant on the course's clock."""
        return f"{instant.astimezone(self.zone):%Y-%m-%d %H:%M}"

    def text(self, lines: Sequence[str], path: str) -> str:
        """Return lines, not too many, and where there is more, if the service knows its address."""
        shown = [*lines[:_MOST_LINES]]
        if len(lines) > _MOST_LINES:
            shown.append(on_page(self.language, "notices.more", count=len(lines) - _MOST_LINES))
        public_url = self.services.providers.public_url
        return "\n".join([*shown, *([f"{public_url}{path}"] if public_url else [])])

    def is_soon(self, due: datetime | None) -> bool:
        """Return whether it is from the day before `due` on, and before `due`."""
        if due is None or self.now >= due:
            return False
        day = (due - _A_SECOND).astimezone(self.zone).date()  # midnight ends the day before
        return self.now >= datetime.combine(day - timedelta(days=1), _DUE_FROM, self.zone)


def write_notices(services: Services, course: str) -> int:
    """Add the notices that the course should get now; return how many there are."""
    wishes, groups = services.notices.wishes(course), services.notices.webhooks(course)
    look = _look(services, course)
    lately = services.notices.made_since(course, look.now - _GATHERED)
    drafts = [
        draft
        for draft in (*_for_groups(look, set(groups)), *_for_people(look, wishes))
        if not _is_to_be_gathered(draft) or (draft.outlet, draft.kind, draft.person) not in lately
    ]
    return services.notices.add(course, drafts) if drafts else 0


def count_as_told(services: Services, course: str, group: Outlet | None, wishes: MailWishes) -> None:
    """Count the present state as reported, so that a new outlet gets no old news."""
    look = _look(services, course)
    drafts = (*_for_groups(look, set() if group is None else {group}), *_for_people(look, wishes))
    services.notices.add(course, [replace(draft, body="") for draft in drafts if _is_to_be_gathered(draft)])


def _is_to_be_gathered(draft: Draft) -> bool:
    """Return whether notices of this kind may come at any time; the others come at a fixed hour."""
    graded = draft.kind is NoticeKind.GRADED and draft.outlet is Outlet.MAIL
    return graded or draft.kind is NoticeKind.FAULTS


def _look(services: Services, course: str) -> _Look:
    members = services.courses.members(course)
    return _Look(
        services=services,
        course=course,
        title=services.courses.get(course).title,
        now=services.clock(),
        rules=services.rules.of(course),
        students=[member for member in members if member.role is Role.STUDENT],
        instructors=[member for member in members if member.role is Role.INSTRUCTOR],
        assignments={assignment.id: assignment for assignment in services.assignments.of(course).all()},
        progress={
            (cell.student, cell.assignment): cell for cell in services.dashboard.state(course).progress
        },
    )


def _for_groups(look: _Look, groups: set[Outlet]) -> Iterator[Draft]:
    if Outlet.CLASS in groups:
        notified = look.services.notices.notified_states(look.course, Outlet.CLASS)
        yield from _due_for_all(look, notified)
        yield from _graded_for_all(look, notified)
    if Outlet.STAFF in groups:
        yield from _faults(
            look, Outlet.STAFF, "", look.services.notices.notified_states(look.course, Outlet.STAFF)
        )


def _for_people(look: _Look, wishes: MailWishes) -> Iterator[Draft]:
    if not wishes:
        return
    notified = look.services.notices.notified_states(look.course, Outlet.MAIL)
    for member in look.students:
        if member.email and wishes.due:
            yield from _due_for_one(look, member.id, notified)
        if member.email and wishes.graded:
            yield from _graded_for_one(look, member.id, notified)
    for member in look.instructors:
        if member.email and wishes.faults:
            yield from _faults(look, Outlet.MAIL, member.id, notified)


def _due_for_all(look: _Look, notified: Mapping[tuple[str, str], str]) -> Iterator[Draft]:
    """Write to a group of dates that rules set. Extensions are left out: they concern one student and staff."""
    lines, until, states = [], look.now, {}
    for id_ in look.assignments:
        rules = look.rules.of(id_)
        if not rules.shown_at(look.now):
            continue
        dates = {look.rules.of(id_, student.id).due for student in look.students}
        soon = sorted(date for date in dates if date is not None and look.is_soon(date))
        state = _digest(*(instant.astimezone(look.zone).isoformat() for instant in soon))
        if not soon or notified.get(("", f"due/{id_}")) == state:
            continue
        states[f"due/{id_}"] = state
        for due in soon:
            sections = [section_rule.section for section_rule in rules.by_section if section_rule.due == due]
            key = "notices.due.line_sections" if sections and len(dates) > 1 else "notices.due.line"
            values = {"title": look.titled(id_), "due": look.local(due), "sections": ", ".join(sections)}
            lines.append(on_page(look.language, key, **values))
            until = max(until, due)
    if lines:
        yield Draft(
            outlet=Outlet.CLASS,
            kind=NoticeKind.DUE,
            heading=on_page(look.language, "notices.due.heading", course=look.title),
            body=look.text(lines, "/"),
            until=until,
            told=states,
        )


def _due_for_one(look: _Look, student: str, notified: Mapping[tuple[str, str], str]) -> Iterator[Draft]:
    """Write to a student who has not handed in anything for it yet."""
    lines, until, states = [], look.now, {}
    for id_ in look.assignments:
        rules = look.rules.of(id_, student)
        due = rules.due_for(look.rules.extension(id_, student))
        if (student, id_) in look.progress or not rules.shown_at(look.now) or not look.is_soon(due):
            continue
        assert due is not None
        state = due.astimezone(look.zone).isoformat()
        if notified.get((student, f"due/{id_}")) != state:
            states[f"due/{id_}"] = state
            lines.append(
                on_page(
                    look.language,
                    "notices.due.line",
                    title=look.titled(id_),
                    due=look.local(due),
                    sections="",
                )
            )
            until = max(until, due)
    if lines:
        yield Draft(
            outlet=Outlet.MAIL,
            kind=NoticeKind.DUE,
            person=student,
            heading=on_page(look.language, "notices.due.heading", course=look.title),
            body=look.text(lines, "/"),
            until=until,
            told=states,
        )


def _graded_for_all(look: _Look, notified: Mapping[tuple[str, str], str]) -> Iterator[Draft]:
    """Report once a day how much was graded; a mean of few or a pass rate would reveal somebody's points."""
    today = look.now.astimezone(look.zone).date()
    end = datetime.combine(today, _GRADED_AT, look.zone)
    if look.now < end or look.now > end + _GRADED_UNTIL or notified.get(("", "graded"), "") >= str(today):
        return
    since = datetime.combine(today - timedelta(days=1), _GRADED_AT, look.zone)
    counts = look.services.notices.graded_between(look.course, since, end)
    lines = [
        on_page(
            look.language,
            "notices.graded.count",
            title=look.titled(id_),
            submissions=submissions,
            students=students,
        )
        for id_, (submissions, students) in sorted(counts.items())
        if look.rules.of(id_).shown_at(look.now)
    ]
    yield Draft(
        outlet=Outlet.CLASS,
        kind=NoticeKind.GRADED,
        heading=on_page(look.language, "notices.graded.heading_all", course=look.title),
        body=look.text(lines, "/submissions") if lines else "",
        until=end + _NEEDED,
        told={"graded": str(today)},
    )


def _graded_for_one(look: _Look, student: str, notified: Mapping[tuple[str, str], str]) -> Iterator[Draft]:
    """Write to a student what counts for an assignment, whatever changed it, once nothing of theirs waits."""
    lines, states = [], {}
    for id_ in look.assignments:
        one = look.progress.get((student, id_))
        if (
            one is None
            or one.state is not SubmissionState.GRADED
            or not look.rules.of(id_).shown_at(look.now)
        ):
            continue
        is_open = bool(look.rules.of(id_).hidden_at(look.now)) or one.waits_for_person
        points = None if is_open else one.counted_score
        state = _digest(one.latest_submission, repr(points), str(one.waits_for_person))
        if notified.get((student, f"graded/{id_}")) == state:
            continue
        states[f"graded/{id_}"] = state
        if points is None or one.max_score is None:
            key = "notices.graded.open" if is_open else "notices.graded.none"
            lines.append(on_page(look.language, key, title=look.titled(id_)))
        else:
            values = {"points": written(points), "most": written(one.max_score)}
            lines.append(on_page(look.language, "notices.graded.points", title=look.titled(id_), **values))
    if lines:
        yield Draft(
            outlet=Outlet.MAIL,
            kind=NoticeKind.GRADED,
            person=student,
            heading=on_page(look.language, "notices.graded.heading", course=look.title),
            body=look.text(lines, "/submissions"),
            until=look.now + _NEEDED,
            told=states,
        )


def _faults(
    look: _Look, outlet: Outlet, person: str, notified: Mapping[tuple[str, str], str]
) -> Iterator[Draft]:
    """Write to staff what the service failed to grade, or that it grades nothing."""
    counts: dict[str, int] = {}
    states = {}
    failed = look.services.notices.given_up_since(look.course, look.now - _LOOKED_BACK)
    for id_, (assignment, attempt) in sorted(failed.items()):
        if notified.get((person, f"fault/{id_}")) != str(attempt):
            states[f"fault/{id_}"] = str(attempt)
            counts[assignment] = counts.get(assignment, 0) + 1
    lines = [
        on_page(look.language, "notices.faults.given_up", title=look.titled(id_), count=count)
        for id_, count in counts.items()
    ]
    stalled = _is_stalled(look)
    if stalled != (notified.get((person, "stalled")) == "yes"):
        states["stalled"] = "yes" if stalled else "no"
        lines += [on_page(look.language, "notices.faults.stalled")] if stalled else []
    if states:
        yield Draft(
            outlet=outlet,
            kind=NoticeKind.FAULTS,
            person=person,
            heading=on_page(look.language, "notices.faults.heading", course=look.title),
            body=look.text(lines, "/class") if lines else "",
            until=look.now + _NEEDED,
            told=states,
        )


def _is_stalled(look: _Look) -> bool:
    """Return whether work of the course waits for long, and nobody is there to grade it."""
    if not any(cell.state is SubmissionState.QUEUED for cell in look.progress.values()):
        return False
    health = look.services.health()
    oldest = health.queue.oldest_queued_at
    return not health.ready and oldest is not None and look.now - oldest > _STALLED


def _digest(*parts: str) -> str:
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()
