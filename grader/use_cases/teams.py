"""Teams: students form them with a code, staff put them together."""

from collections import Counter
from collections.abc import Sequence

from grader.contracts.errors import CourseError, RefusedError
from grader.contracts.identity import Caller, Role
from grader.contracts.submission import Submission
from grader.contracts.team import LARGEST_TEAM, Team
from grader.contracts.text import Text
from grader.store.tokens import typed_code
from grader.use_cases.assignments import require_published, visible_assignment
from grader.use_cases.callers import require_instructor, require_staff
from grader.use_cases.people import person
from grader.use_cases.services import Services


def own_team(services: Services, caller: Caller, assignment_id: str) -> tuple[Team | None, int]:
    """Return the caller's team for an assignment, if there is one, and how many students it takes at most.

    Raises RefusedError: the caller does not see the assignment.
    """
    visible_assignment(services, caller, assignment_id)
    most = team_size(services, caller, assignment_id)
    if caller.course is None or caller.person is None or most == 1:
        return None, most
    return services.teams.of_student(caller.course, assignment_id, caller.person), most


def team_size(services: Services, caller: Caller, assignment_id: str) -> int:
    """Return how many students at most hand in together; 1: each alone."""
    return services.rules.of(caller.course).of(assignment_id).team_size


def people_of(services: Services, caller: Caller, members: Sequence[str]) -> list[str]:
    """Return the members of a team with their names, to somebody of the team or staff."""
    names = {member.id: member.name for member in services.courses.members(caller.course)}
    return [person(names, member) for member in members]


def join_team(services: Services, caller: Caller, assignment_id: str, code: str | None) -> Team:
    """Put the caller, a student, into the team with a code; None: into a new one.

    Raises:
        RefusedError: the assignment is not for teams; or there is no such team, it is full, or the caller's cannot
            be left.
    """
    most = _most(services, caller, assignment_id)
    typed = None if code is None else typed_code(code)
    return services.teams.join(services.signature(caller), assignment_id, typed, most)


def leave_team(services: Services, caller: Caller, assignment_id: str) -> None:
    """Take the caller, a student, out of their team, if there is one.

    Raises RefusedError: the assignment is not for teams; or staff formed the team, or it has handed in.
    """
    _most(services, caller, assignment_id)
    services.teams.leave(services.signature(caller), assignment_id)


def _most(services: Services, caller: Caller, assignment_id: str) -> int:
    visible_assignment(services, caller, assignment_id)
    most = team_size(services, caller, assignment_id)
    if most == 1 or caller.course is None or caller.role is not Role.STUDENT:
        raise RefusedError("no_teams")
    return most


def teams_of(services: Services, caller: Caller, assignment_id: str) -> tuple[Team, ...]:
    """Return the teams for an assignment, to an assistant those with somebody whom they look after.

    Raises RefusedError: the caller may not see the class, or the assignment is not published.
    """
    require_staff(caller)
    require_published(services, caller, assignment_id)
    teams = services.teams.of(caller.course, assignment_id)
    return tuple(team for team in teams if any(map(caller.looks_after, team.members)))


def set_teams(
    services: Services, caller: Caller, assignment_id: str, wanted: Sequence[Sequence[str]]
) -> None:
    """Put teams of students in place of those that there are. What was handed in stays with whoever has it.

    Staff may form teams that are larger than the assignment's `team_size`.

    Raises:
        RefusedError: the caller is no instructor, there is no such course, assignment or student, somebody stands
            in two teams, or one is too large.
    """
    require_instructor(caller)
    require_published(services, caller, assignment_id)
    if caller.course is None:
        raise RefusedError("no_course")
    students = {
        member.id for member in services.courses.members(caller.course) if member.role is Role.STUDENT
    }
    counted = Counter(member for team in wanted for member in team)
    unknown = sorted(counted.keys() - students)
    if unknown:
        text = Text(zh=f"课程里没有这个学生：{unknown[0]}。", en=f"The course has no student {unknown[0]}.")
        raise RefusedError("unknown_student", text, field="teams")
    twice = next((one for one, number in counted.items() if number > 1), None)
    if twice is not None:
        text = Text(zh=f"{twice} 出现了两次。", en=f"{twice} stands there twice.")
        raise RefusedError("invalid_request", text, field="teams")
    if any(not 1 <= len(team) <= LARGEST_TEAM for team in wanted):
        text = Text(zh=f"每个队 1 到 {LARGEST_TEAM} 人。", en=f"A team has 1 to {LARGEST_TEAM} students.")
        raise RefusedError("invalid_request", text, field="teams")
    try:
        services.teams.set(services.signature(caller), assignment_id, wanted)
    except CourseError:  # removed in between
        raise RefusedError("unknown_student", field="teams") from None


def handed_in_for(services: Services, caller: Caller, submission: Submission) -> list[str]:
    """Return whose submission the upload is, with names, in order; nobody: it was not a team's."""
    if submission.team_upload is None:
        return []
    return people_of(services, caller, services.submissions.students_of_upload(submission.team_upload))
