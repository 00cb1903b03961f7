"""Teams of students, by assignment: formed by students with a code, or by staff."""

from collections.abc import Iterable, Sequence

from sqlalchemy import ColumnElement, delete, exists, select
from sqlmodel import Session, col

from grader.contracts.errors import RefusedError
from grader.contracts.identity import unknown_members
from grader.contracts.team import Team
from grader.store.audit import Signature, record, require_open
from grader.store.database import StorePart, one_at_a_time
from grader.store.tables import MemberRow, SubmissionRow, TeamMemberRow
from grader.store.tokens import random_code

_CODE_LENGTH = 8  # of 26 letters and digits: nobody guesses one


class Teams(StorePart):
    """Keeps who hands in together; every change is in the audit log. Safe to share between threads."""

    def of(self, course: str | None, assignment: str) -> tuple[Team, ...]:
        """Return the teams of an assignment, in order of their first members."""
        with self._database.reading() as session:
            return _teams(session, course, assignment)

    def of_student(self, course: str | None, assignment: str, person: str) -> Team | None:
        """Return the team of a student; None: they hand in alone."""
        return _team_with(self.of(course, assignment), person)

    def join(self, signed: Signature, assignment: str, code: str | None, most: int) -> Team:
        """Put whoever signs into the team with `code`; None: into a new one.

        Raises RefusedError: there is no such team, it has `most` members, or theirs cannot be left.
        """
        course, person = signed.in_course(), signed.actor
        with self._database.writing() as session:
            teams = _teams_to_change(session, course, assignment)
            own = _team_with(teams, person)
            team = Team(code=random_code(_CODE_LENGTH), members=(), by_staff=False)
            if code is not None:
                team = _joinable(teams, code, most, person)
            elif own is not None:
                return own
            if own is not None and own.code == team.code:
                return own
            _require_free(session, signed, assignment, own)
            session.merge(_row(course, assignment, person, team))
            joined = Team(code=team.code, members=tuple(sorted([*team.members, person])), by_staff=False)
            _record(session, signed, assignment, [] if own is None else own.members, joined.members)
            return joined

    def leave(self, signed: Signature, assignment: str) -> None:
        """Take whoever signs out of their team, if they are in one.

        Raises RefusedError: it cannot be left.
        """
        course, person = signed.in_course(), signed.actor
        with self._database.writing() as session:
            teams = _teams_to_change(session, course, assignment)
            own = _team_with(teams, person)
            if own is None:
                return
            _require_free(session, signed, assignment, own)
            session.execute(delete(TeamMemberRow).where(*_of(course, assignment, person)))
            _record(session, signed, assignment, own.members, [])

    def set(self, signed: Signature, assignment: str, wanted: Sequence[Sequence[str]]) -> None:
        """Make `wanted`, where nobody stands twice, the teams of an assignment.

        A team whose members do not change remains one of students or of staff, as it was; the others are staff's.

        Raises:
            CourseError: one of them is no member.
            RefusedError: the course is archived.
        """
        course = signed.in_course()
        with self._database.writing() as session:
            before = _teams_to_change(session, course, assignment)
            _require_members(session, course, [person for team in wanted for person in team])
            before_by_members = {one.members: one for one in before}
            session.execute(delete(TeamMemberRow).where(*_of(course, assignment)))
            for members in map(tuple, map(sorted, wanted)):
                team = before_by_members.get(members) or Team(
                    code=random_code(_CODE_LENGTH), members=members, by_staff=True
                )
                session.add_all(_row(course, assignment, person, team) for person in members)
            after = sorted(sorted(one) for one in wanted)
            if after != (was := [list(one.members) for one in before]):
                subject = f"assignment {assignment}"
                record(session, signed, "team.set", subject, before={"teams": was}, after={"teams": after})


def members_of(session: Session, course: str | None, assignment: str, team: str) -> tuple[str, ...]:
    """Return who is in a team, in order."""
    in_team = select(col(TeamMemberRow.person)).where(
        *_of(course, assignment), col(TeamMemberRow.team) == team
    )
    return tuple(session.execute(in_team.order_by(col(TeamMemberRow.person))).scalars())


def locked_upload(session: Session, submission_id: str) -> tuple[SubmissionRow | None, list[SubmissionRow]]:
    """Return a submission, and the others that came with the same upload of a team; all of them locked."""
    row = session.get(SubmissionRow, submission_id)
    if row is None or row.team_upload is None:
        return session.get(SubmissionRow, submission_id, with_for_update=True), []
    same = select(SubmissionRow).where(col(SubmissionRow.team_upload) == row.team_upload)
    in_order = same.order_by(
        col(SubmissionRow.id)
    ).with_for_update()  # or two wait for each other in a circle
    rows = session.execute(in_order.execution_options(populate_existing=True)).scalars().all()
    return row, [other for other in rows if other is not row]


def _teams(session: Session, course: str | None, assignment: str) -> tuple[Team, ...]:
    members: dict[tuple[str, bool], list[str]] = {}
    rows = select(TeamMemberRow).where(*_of(course, assignment)).order_by(col(TeamMemberRow.person))
    for row in session.execute(rows).scalars():
        members.setdefault((row.team, row.by_staff), []).append(row.person)
    return tuple(
        Team(code=code, members=tuple(people), by_staff=by_staff)
        for (code, by_staff), people in members.items()
    )


def _teams_to_change(session: Session, course: str, assignment: str) -> tuple[Team, ...]:
    """Return the teams of an open course, which nobody else changes before the transaction ends."""
    require_open(session, course)
    one_at_a_time(session, "teams", course, assignment)
    return _teams(session, course, assignment)


def _team_with(teams: Iterable[Team], person: str) -> Team | None:
    return next((team for team in teams if person in team.members), None)


def _of(course: str | None, assignment: str, *person: str) -> list[ColumnElement[bool]]:
    row = TeamMemberRow
    theirs = [col(row.person) == id_ for id_ in person]
    return [col(row.course) == course, col(row.assignment) == assignment, *theirs]


def _row(course: str, assignment: str, person: str, team: Team) -> TeamMemberRow:
    return TeamMemberRow(
        course=course, assignment=assignment, person=person, team=team.code, by_staff=team.by_staff
    )


def _joinable(teams: Iterable[Team], code: str, most: int, person: str) -> Team:
    team = next((other for other in teams if other.code == code and not other.by_staff), None)
    if team is None:
        raise RefusedError("team_not_found", field="code")
    if len(team.members) >= most and person not in team.members:
        raise RefusedError("team_full", field="code")
    return team


def _require_free(session: Session, signed: Signature, assignment: str, own: Team | None) -> None:
    """Refuse where whoever signs is in a team of the staff's, or in one that has handed in with them."""
    row = SubmissionRow
    handed_in = exists().where(
        col(row.course) == signed.course,
        col(row.student) == signed.actor,
        col(row.assignment) == assignment,
        col(row.team_upload).is_not(None),
    )
    if own is not None and (own.by_staff or session.execute(select(handed_in)).scalar_one()):
        raise RefusedError("team_fixed")


def _require_members(session: Session, course: str, people: Sequence[str]) -> None:
    in_course = select(col(MemberRow.person)).where(col(MemberRow.course) == course)
    unknown = sorted(set(people) - set(session.execute(in_course).scalars()))
    if unknown:
        raise unknown_members(course, *unknown)


def _record(
    session: Session, signed: Signature, assignment: str, before: Sequence[str], after: Sequence[str]
) -> None:
    subject = f"assignment {assignment}, member {signed.actor}"
    record(session, signed, "team.change", subject, before={"team": [*before]}, after={"team": [*after]})
