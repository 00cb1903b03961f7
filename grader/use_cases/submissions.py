"""Reading a submission: where it stands, how it was graded, the file itself, and the attempts beside it."""

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass, replace
from datetime import datetime

from grader.contracts.assignment import Assignment
from grader.contracts.errors import RefusedError
from grader.contracts.identity import Caller
from grader.contracts.submission import StoredReport, Submission, SubmissionFilter, SubmissionState
from grader.contracts.upload import same_program
from grader.store.intake import as_attempts
from grader.store.rules import CourseRules
from grader.use_cases import explaining
from grader.use_cases.assignments import all_terms, checklist, require_published
from grader.use_cases.callers import require_staff
from grader.use_cases.services import Services
from grader.use_cases.visibility import found_by_rules, shown_list, visible_submission

_OPEN = (SubmissionState.QUEUED, SubmissionState.RUNNING)


@dataclass(frozen=True, slots=True, kw_only=True)
class Lateness:
    """What handing in late costs one submission.

    Attributes:
        late_s: seconds after the student's due date.
        kept_share: of its points. kept_score: what that leaves of its score; None while it has none.
    """

    late_s: float
    kept_share: float
    kept_score: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class ShownSubmission:
    """A submission and its latest grading, as the caller may see them.

    Attributes:
        grading: None before the first. told: what is said of it.
        position: how many are before it while it waits.
        estimated_finish_at: None when it is graded, or nobody can say.
    """

    submission: Submission
    grading: StoredReport | None
    position: int | None
    estimated_finish_at: datetime | None
    lateness: Lateness
    told: explaining.Told | None


@dataclass(frozen=True, slots=True, kw_only=True)
class StudentInClass:
    """The student of a submission, and the latest submissions of the students before and after in the class.

    Attributes:
        name: the student's; empty if it is the same as the id.
        previous, next: to the same assignment; None if there is none.
    """

    name: str
    previous: Submission | None
    next: Submission | None


@dataclass(frozen=True, slots=True, kw_only=True)
class PastAttempt:
    """A submission in a list of its student's: what lateness costs it, and whether it is the one that counts."""

    submission: Submission
    lateness: Lateness
    counts: bool


def listed(
    services: Services, caller: Caller, wanted: SubmissionFilter, limit: int
) -> tuple[tuple[Submission, ...], str | None]:
    """Return at most `limit` submissions in the order of their arrival, and the `after` of the next page.

    Students get their own, whatever `wanted` says; the staff get those of the class. An instant without an offset
    is on the clock of the course.

    Raises:
        RefusedError: nobody knows who the caller is; or nothing fits, and `wanted` names an assignment that is
            not there, or somebody who is not in the class.
    """
    if not caller.is_staff:
        if caller.course is None or caller.person is None:
            require_staff(caller)
        wanted = replace(wanted, student=caller.person)
    if wanted.since is not None and wanted.since.tzinfo is None:
        zone = services.rules.of(caller.course).zone
        wanted = replace(wanted, since=wanted.since.replace(tzinfo=zone))
    submissions = services.submissions.of_class(caller.course, wanted, limit + 1, caller.students)
    if not submissions:
        _require_known(services, caller, wanted)
    page = submissions[:limit]
    return shown_list(services, caller, page), page[-1].id if len(submissions) > limit else None


def _require_known(services: Services, caller: Caller, wanted: SubmissionFilter) -> None:
    """Refuse a misspelt name, which would seem to say that nobody handed in."""
    if wanted.assignment is not None:
        require_published(services, caller, wanted.assignment, "unknown_assignment", field="assignment")
    if wanted.student is not None and caller.course is not None:
        member = services.courses.member(caller.course, wanted.student)
        if member is None or not caller.looks_after(wanted.student):
            raise RefusedError("unknown_student", field="student")


def read(services: Services, caller: Caller, submission_id: str) -> ShownSubmission:
    """Return where a submission stands, and its grading once there is one.

    Raises RefusedError: the caller may not see it.
    """
    submission, grading, rules = found_by_rules(services, caller, submission_id)
    position, estimated = place(services, submission)
    return ShownSubmission(
        submission=submission,
        grading=grading,
        position=position,
        estimated_finish_at=estimated,
        lateness=_lateness(submission, rules),
        told=None if grading is None else explaining.told_of(services, caller, submission, grading, rules),
    )


def student_in_class(services: Services, caller: Caller, submission: Submission) -> StudentInClass:
    """Return the name of a submission's student, and the submissions of the students before and after.

    For staff.
    """
    require_staff(caller)
    course, student = submission.course, submission.student
    member = None if course is None else services.courses.member(course, student)
    return StudentInClass(
        name="" if member is None or member.name == student else member.name,
        previous=services.submissions.neighbour(submission, caller.students, after=False),
        next=services.submissions.neighbour(submission, caller.students, after=True),
    )


def is_open(submission: Submission) -> bool:
    """Whether more will happen to a submission by itself."""
    return submission.state in _OPEN


def place(services: Services, submission: Submission) -> tuple[int | None, datetime | None]:
    """Return how many are before a submission while it waits, and when it will probably be graded."""
    if not is_open(submission):
        return None, None
    is_waiting = submission.state is SubmissionState.QUEUED
    position = services.queue.position(submission.id) if is_waiting else None
    return position, services.watching.estimates.finish(submission, position)


def read_source(services: Services, caller: Caller, submission_id: str) -> tuple[Submission, bytes]:
    """Return a submission and its file, byte for byte. Raises RefusedError: the caller may not see it."""
    submission = visible_submission(services, caller, submission_id)
    return submission, services.submissions.source(submission_id) or b""


def is_untouched(services: Services, submission: Submission) -> bool:
    """Return whether a submission is its published assignment's starter as it was given."""
    if not submission.file_name.lower().endswith(".py"):
        return False
    starter = services.assignments.of(submission.course).starter(submission.assignment)
    return bool(starter) and same_program(services.submissions.source(submission.id) or b"", starter)


@dataclass(frozen=True, slots=True, kw_only=True)
class CourseProgress:
    """How many exercises have full marks, of how many; and the first that has not and takes files; None: none."""

    done: int
    count: int
    next: Assignment | None


def course_progress(services: Services, caller: Caller, student: str) -> CourseProgress:
    """Return how far a student has come with what they see of the course.

    Raises RefusedError: the student's work is not the caller's to see.
    """
    best = best_of(attempts(services, caller, student))
    every, terms = checklist(services, caller), all_terms(services, caller)

    def is_done(one: Assignment) -> bool:
        return one.id in best and (best[one.id].score or 0.0) >= one.max_score

    left = [assignment for assignment in every if not is_done(assignment)]
    waiting = (
        assignment
        for assignment in left
        if assignment.id not in terms or terms[assignment.id].refusal is None
    )
    return CourseProgress(done=len(every) - len(left), count=len(every), next=next(waiting, None))


def attempts(
    services: Services, caller: Caller, student: str, assignment: str | None = None
) -> tuple[Submission, ...]:
    """Return a student's submissions, newest first, as the caller may see them; only those to `assignment`.

    Raises RefusedError: the student's work is not the caller's to see.
    """
    if not caller.may_see(caller.course, student):
        raise RefusedError("forbidden")
    own = services.submissions.of_student(student, assignment, course=caller.course)
    return shown_list(services, caller, own)


def history(
    services: Services, caller: Caller, student: str, assignment: str | None = None
) -> tuple[PastAttempt, ...]:
    """Return a student's submissions as `attempts` does, each with what the rules make of it.

    Raises RefusedError: the student's work is not the caller's to see.
    """
    listed, rules = attempts(services, caller, student, assignment), services.rules.of(caller.course)
    counted = set() if caller.course is None else _counted(listed, rules, caller, services.clock())
    return tuple(
        PastAttempt(
            submission=submission, lateness=_lateness(submission, rules), counts=submission.id in counted
        )
        for submission in listed
    )


def _counted(listed: Iterable[Submission], rules: CourseRules, caller: Caller, now: datetime) -> set[str]:
    """Return the ids of the attempts that count; of none with items that are hidden from the caller."""
    own: dict[str, list[Submission]] = defaultdict(list)
    for submission in listed:
        if caller.is_staff or not rules.of(submission.assignment).hidden_at(now):
            own[submission.assignment].append(submission)
    counting = (
        rules.of(assignment, some[0].student).counting(
            rules.extension(assignment, some[0].student), as_attempts(some)
        )
        for assignment, some in own.items()
    )
    return {attempt.attempt.id for attempt in counting if attempt is not None}


def best_of(submissions: Iterable[Submission]) -> dict[str, Submission]:
    """Return the submission with the best score by assignment; the first of several, nothing without a score."""
    best: dict[str, Submission] = {}
    for submission in submissions:
        other = best.get(submission.assignment)
        if submission.score is not None and (other is None or submission.score > (other.score or 0)):
            best[submission.assignment] = submission
    return best


def _lateness(submission: Submission, course_rules: CourseRules) -> Lateness:
    rules = course_rules.of(submission.assignment, submission.student)
    extension = course_rules.extension(submission.assignment, submission.student)
    score, received_at = submission.score, submission.received_at
    return Lateness(
        late_s=rules.late_s(extension, received_at),
        kept_share=rules.kept_share(extension, received_at),
        kept_score=None if score is None else rules.kept_score(extension, score, received_at),
    )
