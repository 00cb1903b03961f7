"""Comments: a course's staff and a student write to each other about a submission, or about a line of it."""

from dataclasses import dataclass

from grader.contracts.comment import LONGEST_COMMENT, Comment, is_comment
from grader.contracts.errors import RefusedError
from grader.contracts.identity import Caller, Role
from grader.contracts.submission import Submission
from grader.contracts.text import Text
from grader.contracts.upload import lines_of
from grader.formats.packages.bundle import text_of
from grader.use_cases.services import Services
from grader.use_cases.visibility import visible_submission

_WRONG_TEXT = Text(
    zh=f"评论要有内容，最多 {LONGEST_COMMENT} 个字符，不能有控制字符。",
    en=f"A comment has 1 to {LONGEST_COMMENT} characters and no control characters.",
)
_FULL = Text(
    zh="这份提交的评论已经太多，不能再加。", en="There are too many comments on this submission already."
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Unread:
    """What the other side wrote and the caller's side has not seen. `first`: the submission to begin with."""

    count: int
    first: str


def comments(services: Services, caller: Caller, submission_id: str) -> tuple[Comment, ...]:
    """Return the comments on a submission, oldest first. Raises RefusedError: the caller may not see it."""
    return services.comments.of(visible_submission(services, caller, submission_id).id)


def read_comments(services: Services, caller: Caller, submission: Submission) -> tuple[Comment, ...]:
    """Return the comments on a submission, and note that the caller, who may see it, has seen them."""
    comments = services.comments.of(submission.id)
    is_student = caller.role is Role.STUDENT
    if any(comment.by_student is not is_student and not comment.seen for comment in comments):
        services.comments.mark_seen(submission.id, services.clock(), by_student=is_student)
    return comments


def add_comment(
    services: Services, caller: Caller, submission_id: str, text: str, line: int | None
) -> Comment:
    """Keep what the caller writes about a submission, or about one line of its file.

    Raises:
        RefusedError: the caller may not see it, there is no course whose people could write, the text is empty or
            too long, there is no such line, or there are too many comments.
    """
    submission = visible_submission(services, caller, submission_id)
    if caller.course is None or caller.person is None:
        raise RefusedError("no_course")
    text = checked_text(text, LONGEST_COMMENT, _WRONG_TEXT)
    if line is not None:
        last = len(lines_of(text_of(services.submissions.source(submission.id) or b"")))
        if not 1 <= line <= last:
            detail = Text(zh=f"文件有 {last} 行。", en=f"The file has {last} lines.")
            raise RefusedError("invalid_request", detail, field="line")
    signed, is_student = services.signature(caller), caller.role is Role.STUDENT
    added = services.comments.add(submission.id, text, line, signed, by_student=is_student)
    if added is None:
        raise RefusedError("invalid_request", _FULL)
    return added


def checked_text(text: str, longest: int, refusal: Text, field: str = "text") -> str:
    """Return what somebody wrote, without the empty lines around it.

    Raises RefusedError: it is empty or longer than `longest`, or has control characters; `refusal` says so.
    """
    text = text.replace("\r\n", "\n").strip()
    if not text or not is_comment(text, longest):
        raise RefusedError("invalid_request", refusal, field=field)
    return text


def unread(services: Services, caller: Caller) -> Unread | None:
    """Return what the other side wrote and the caller's side has not seen; None if it has seen everything."""
    if caller.course is None or caller.person is None:
        return None
    if caller.is_staff:
        counts = services.comments.unseen_by_staff(caller.course, caller.students)
    else:
        counts = services.comments.unseen_by_student(caller.course, caller.person)
    return Unread(count=sum(counts.values()), first=next(iter(counts))) if counts else None


def author_names(services: Services, comments: tuple[Comment, ...], course: str | None) -> dict[str, str]:
    """Return the names of the authors of comments, by id."""
    if course is None:
        return {}
    members = {comment.by: services.courses.member(course, comment.by) for comment in comments}
    return {id_: id_ if member is None else member.name or id_ for id_, member in members.items()}
