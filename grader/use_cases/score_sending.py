"""Keeping the scores on learning platforms up to date: looks regularly, and sends only what differs."""

import hashlib
import logging
from collections.abc import Callable, Iterator, Mapping
from datetime import timedelta

import msgspec

from grader.contracts.dashboard import StudentProgress
from grader.contracts.platform import Platform, PlatformLink
from grader.messages import on_page
from grader.outside.lti.scores import NotTakenError, Score
from grader.outside.signin.channel import UnreachableError
from grader.store.clock import ahead
from grader.use_cases.services import Services

_log = logging.getLogger(__name__)
_A_SECOND = timedelta(seconds=1)


def send_scores(services: Services, stopped: Callable[[], bool] = lambda: False) -> int:
    """Send every platform the scores that it does not have yet, until `stopped`; return how many were taken."""
    taken = 0
    silent: set[str] = set()
    for platform, link in services.platform_scores.targets():
        try:
            for person, score in _scores_of(services, platform, link):
                if platform.id in silent or stopped():
                    break
                taken += _send_score(services, platform, link, person, score)
        except UnreachableError as error:
            _log.warning("%s does not take scores now: %s", platform.title, error)
            silent.add(platform.id)  # the others there would wait as long for nothing
        except Exception:  # whatever it is, the other courses' platforms have nothing to do with it
            _log.warning("scores could not be sent to %s; tried again soon", platform.title, exc_info=True)
    return taken


def _send_score(services: Services, platform: Platform, link: PlatformLink, person: str, score: Score) -> int:
    """Send one score; return whether it was taken."""
    store, now, digest = services.platform_scores, services.clock(), _digest(score)
    claimed = store.claim(link, platform.course, person, digest)
    if claimed is None:
        return 0
    at = now if claimed.sent_at is None else max(now, claimed.sent_at + _A_SECOND)
    try:
        services.platform_channel.send(platform, link.line_item, score, at)
    except NotTakenError as error:
        store.failed(link, person, claimed.tries + 1, str(error))
        return 0
    except UnreachableError as error:
        store.failed(link, person, claimed.tries + 1, str(error))
        raise
    store.sent(link, person, digest, at)
    return 1


def _scores_of(services: Services, platform: Platform, link: PlatformLink) -> Iterator[tuple[str, Score]]:
    """Yield members whose score differs from what the platform took."""
    people = services.platform_scores.people(platform)
    if not people:
        return
    sent, now = services.platform_scores.of_link(link), services.clock()
    hidden = bool(services.rules.of(platform.course).of(link.assignment).hidden_at(now))
    for progress in services.dashboard.state(platform.course).progress:
        if progress.assignment != link.assignment or progress.student not in people:
            continue
        score = _score(services, people, progress, hidden=hidden)
        row = sent.get(progress.student)
        due = row is None or not ahead(row.not_before, now)
        if score is not None and due and (row is None or row.sha256 != _digest(score)):
            yield progress.student, score


def _score(
    services: Services, people: Mapping[str, str], progress: StudentProgress, *, hidden: bool
) -> Score | None:
    """Return the score that a platform should have; None: nothing counts yet.

    While items are hidden, or a person still gives points, the score says that there is work, without points.
    """
    if progress.max_score is None or (progress.counted_score is None and not progress.waits_for_person):
        return None
    open_ = hidden or progress.waits_for_person
    shown = progress.counted_submission or progress.latest_submission
    address = f"{services.providers.public_url}/submissions/{shown}"
    return Score(
        subject=people[progress.student],
        given=None if open_ else progress.counted_score,
        most=progress.max_score,
        comment=on_page(services.settings.default_language, "platforms.comment", address=address),
    )


def _digest(score: Score) -> str:
    return hashlib.sha256(msgspec.json.encode(score)).hexdigest()
