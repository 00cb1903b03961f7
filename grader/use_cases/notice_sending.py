"""Sending notices, in a thread of its own: no grading, no request and no score waits for a webhook."""

import logging
from collections.abc import Callable

from grader.contracts.notice import Notice, Outlet
from grader.outside.notices import OFTEN_PAUSE_S, NotSentError
from grader.outside.notices.mail import Letter
from grader.use_cases.notice_writing import write_notices
from grader.use_cases.services import Services

_log = logging.getLogger(__name__)


def send_notices(services: Services, stopped: Callable[[], bool] = lambda: False) -> int:
    """Write and send the notices of every course, until `stopped`; return how many were taken."""
    for course in services.notices.courses():
        try:
            write_notices(services, course)
        except Exception:  # whatever it is, the other courses have nothing to do with it
            _log.warning("notices of course %s could not be written", course, exc_info=True)
    services.notices.give_up()
    taken = 0
    for waiting in services.notices.waiting():
        if stopped():
            break
        notice = services.notices.claim(waiting.id)
        if notice is None:
            continue
        try:
            taken += _send(services, notice)
        except NotSentError as error:  # whose others are put off with it
            _failed(services, notice, error)
        except Exception:  # whatever it is, the others have nothing to do with it
            _log.warning("a notice of course %s could not be sent", notice.course, exc_info=True)
    return taken


def _send(services: Services, notice: Notice) -> bool:
    """Send one notice; return whether there was somebody to send it to."""
    if notice.outlet is Outlet.MAIL:
        member = services.courses.member(notice.course, notice.person)
        if member is None or not member.email or services.mail is None:
            services.notices.drop(notice)
            return False
        letter = Letter(
            id=notice.id, to=member.email, heading=notice.heading, body=notice.body, at=notice.made_at
        )
        services.mail.send(letter)
    else:
        webhook = services.notices.webhooks(notice.course).get(notice.outlet)
        if webhook is None:
            services.notices.drop(notice)
            return False
        services.bots.send(webhook, f"{notice.heading}\n{notice.body}")
    services.notices.sent(notice)
    return True


def _failed(services: Services, notice: Notice, error: NotSentError) -> None:
    _log.warning("course %s, %s: a notice is not taken now: %s", notice.course, notice.outlet.value, error)
    least = OFTEN_PAUSE_S if error.code == "too_often" else 0.0
    services.notices.failed(notice, error.code, error.detail, least_pause_s=least, alone=error.is_persons)
