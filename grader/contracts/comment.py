"""What staff and a student write to each other about one submission."""

import re
from dataclasses import dataclass
from datetime import datetime
from typing import Final

LONGEST_COMMENT = 2_000
"""Characters of a comment, be it on a submission or with the points that a person gave."""

COMMENT_PATTERN: Final = r"^[^\x00-\x08\x0b\x0c\x0e-\x1f\x7f]*$"
"""What a comment may consist of: no control characters but tabs and ends of lines."""

MOST_COMMENTS = 200
"""On one submission."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Comment:
    """One comment. Nobody changes it afterwards.

    Attributes:
        number: 1 for the first one on the submission, then 2, ...
        by: who wrote it. by_student: the submission's student did, and not the staff.
        line: of the file, from 1; None: about the whole.
        seen: somebody of the other side has opened the submission since.
    """

    submission: str
    number: int
    by: str
    by_student: bool
    line: int | None
    text: str
    at: datetime
    seen: bool


def is_comment(text: str, longest: int) -> bool:
    """Whether `text`, which may be empty, is fit to be kept and shown as what somebody wrote."""
    return len(text) <= longest and re.search(COMMENT_PATTERN, text) is not None
