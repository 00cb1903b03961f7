"""Choosing which assignments a platform makes activities of (`grader.outside.lti.picking`).

It is done in a frame of the platform's page, where a browser has no session of ours. Whoever came with the
platform's signed message has a secret instead, which is good for that one choice. Who they are in the course is
what the class list says, as ever.
"""

from collections.abc import Collection
from dataclasses import dataclass

from grader.contracts.assignment import Assignment
from grader.contracts.errors import RefusedError
from grader.contracts.identity import Member, Role
from grader.contracts.platform import OpenPicking, Platform
from grader.contracts.text import Language
from grader.outside.lti.picking import activity, answer
from grader.use_cases.platforms import public_url
from grader.use_cases.services import Services


@dataclass(frozen=True, slots=True, kw_only=True)
class PickingDesk:
    """What somebody may choose from.

    Attributes:
        asked: what the platform asks for.
        known: whether it is clear who they are; else they show their token first.
        offered: the course's assignments. hidden: ids of those that students do not see now.
    """

    platform: Platform
    asked: OpenPicking
    known: bool
    offered: tuple[Assignment, ...] = ()
    hidden: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True, kw_only=True)
class Chosen:
    """What a browser brings back to the platform: a signed message, to the address `back`."""

    back: str
    message: str


def desk_of(services: Services, secret: str) -> PickingDesk:
    """Return what the holder of a secret may choose from.

    Raises RefusedError: the secret is none, or too old; or its holder is no instructor of the course.
    """
    platform, asked = _opened(services, secret)
    member = _member(services, platform, asked)
    if member is None:
        return PickingDesk(platform=platform, asked=asked, known=False)
    if member.role is not Role.INSTRUCTOR:
        raise RefusedError("picking_by_instructors")
    offered, now = services.assignments.of(platform.course).all(), services.clock()
    of_course = services.rules.of(platform.course)
    hidden = frozenset(
        assignment.id for assignment in offered if not of_course.of(assignment.id).shown_at(now)
    )
    return PickingDesk(platform=platform, asked=asked, known=True, offered=offered, hidden=hidden)


def show_token(services: Services, secret: str, token: str) -> bool:
    """Note who the holder of a secret is, by the token that they show; False: it is nobody's of the course.

    Raises RefusedError: the secret is none, or too old; or they are no instructor, or known as another member.
    """
    platform, asked = _opened(services, secret)
    caller = services.tokens.caller(token)
    if caller is None or caller.person is None or caller.course != platform.course:
        return False
    if not caller.is_instructor:  # before it is noted: an account stays whose it is
        raise RefusedError("picking_by_instructors")
    if not services.identities.bind(
        platform.provider, asked.subject, platform.course, caller.person, by_token=True
    ):
        raise RefusedError("signin_somebody_else")
    return True


def choose(services: Services, secret: str, chosen: Collection[str], language: Language) -> Chosen:
    """Return what the platform is answered: activities of the assignments `chosen`, titled in a language.

    Raises as `desk_of`; or nothing was chosen, more than the platform takes, or what is not offered.
    """
    desk = desk_of(services, secret)
    taken = [assignment for assignment in desk.offered if assignment.id in chosen]
    if not taken or len(taken) != len(set(chosen)) or (len(taken) > 1 and not desk.asked.several):
        raise RefusedError("nothing_picked")
    address = f"{public_url(services)}/"
    items = [activity(assignment, language, address, scored=desk.asked.scored) for assignment in taken]
    claims = answer(desk.platform, desk.asked, items, services.clock().timestamp())
    return Chosen(back=desk.asked.back, message=services.platform_channel.signed(claims))


def _opened(services: Services, secret: str) -> tuple[Platform, OpenPicking]:
    asked = services.platforms.picking(secret)
    platform = None if asked is None else services.platforms.get(asked.platform)
    if asked is None or platform is None:
        raise RefusedError("picking_over")
    return platform, asked


def _member(services: Services, platform: Platform, asked: OpenPicking) -> Member | None:
    identities = services.identities.of_subject(platform.provider, asked.subject)
    person = next((identity.person for identity in identities if identity.course == platform.course), None)
    return None if person is None else services.courses.member(platform.course, person)
