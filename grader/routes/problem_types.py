"""Every kind of problem the interface answers with. Codes are stable.

Beside the table of codes stand, in the catalogue of texts, ``problem.<code>.title``: what it means, and
``problem.<code>.fix``: what the person who sees it can do.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

from grader.contracts.text import Text
from grader.messages import say


@dataclass(frozen=True, slots=True)
class ProblemType:
    """One kind of problem.

    Attributes:
        status: HTTP's. headers: of every answer with this problem.
    """

    code: str
    status: int
    headers: Mapping[str, str] = field(default_factory=dict)

    @property
    def title(self) -> Text:
        """What it means, in a few words."""
        return say(f"problem.{self.code}.title")

    @property
    def fix(self) -> Text:
        """What the person who sees it can do."""
        return say(f"problem.{self.code}.fix")


_STATUS = {
    "malformed_body": 400,
    "unauthorized": 401,
    "not_open_yet": 403,
    "closed": 403,
    "no_attempts_left": 403,
    "no_attempts_today": 403,
    "forbidden": 403,
    "foreign_form": 403,
    "not_found": 404,
    "submission_not_found": 404,
    "assignment_not_found": 404,
    "no_trajectory": 404,
    "regrade_not_found": 404,
    "item_not_found": 404,
    "problem_not_found": 404,
    "method_not_allowed": 405,
    "not_graded_yet": 409,
    "judged_meanwhile": 412,
    "changed_meanwhile": 412,
    "too_large": 413,
    "unsupported_media_type": 415,
    "wrong_file_type": 415,
    "invalid_request": 422,
    "invalid_points": 422,
    "points_unchanged": 422,
    "invalid_student": 422,
    "regrade_open": 409,
    "regrade_running": 409,
    "regrade_decided": 409,
    "nothing_to_regrade": 422,
    "no_course": 409,
    "invalid_rules": 422,
    "unknown_student": 422,
    "unknown_assignment": 422,
    "empty": 422,
    "not_utf8": 422,
    "contains_nul": 422,
    "syntax_error": 422,
    "key_reused": 422,
    "too_many_open": 429,
    "too_many_requests": 429,
    "too_many_streams": 429,
    "streams_full": 503,
    "internal_error": 500,
    "unavailable": 503,
    "refused": 400,
}
_HEADERS = {
    "unauthorized": {"WWW-Authenticate": 'Bearer realm="grader"'},
    "unsupported_media_type": {"Accept": "multipart/form-data"},
}
PROBLEM_TYPES: Mapping[str, ProblemType] = {
    code: ProblemType(code, status, _HEADERS.get(code, {})) for code, status in _STATUS.items()
}
