"""What a waiting student reads: the state, the place in line, and about how long it will take."""

import math
from datetime import datetime
from typing import Any

from grader.contracts.submission import SubmissionState
from grader.contracts.text import Language
from grader.messages import on_page
from grader.render.labels import status_word

_SOON_S = 5.0
_MINUTE_S = 60.0


def progress(
    state: SubmissionState, position: int | None, left_s: float | None, language: Language, *, is_open: bool
) -> dict[str, Any]:
    """Return where a submission stands, with the sentence that says so.

    `position`: how many are before it while it waits. `left_s`: seconds until it will probably be graded; None:
    nobody can say. `is_open`: more will happen by itself.
    """
    parts = [status_word(state, language)]
    if is_open and position is not None:
        ahead = on_page(language, "progress.ahead", count=position)
        parts.append(ahead if position > 0 else on_page(language, "progress.next"))
    if is_open and left_s is not None:
        parts.append(_rounded_time(left_s, language))
    text = on_page(language, "comma").join(parts)
    return {"open": is_open, "state": state.value, "text": text, "position": position}


def left_s(estimated_at: datetime | None, now: datetime) -> float | None:
    """Return the seconds until an estimated end; None when there is none."""
    return None if estimated_at is None else max((estimated_at - now).total_seconds(), 0.0)


def _rounded_time(seconds: float, language: Language) -> str:
    if seconds <= _SOON_S:
        return on_page(language, "progress.soon")
    if seconds <= 1.5 * _MINUTE_S:
        return on_page(language, "progress.seconds", count=5 * math.ceil(seconds / 5.0))
    return on_page(language, "progress.minutes", count=math.ceil(seconds / _MINUTE_S))
