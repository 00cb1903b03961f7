"""Adding the people of a platform's course to the class list. Nobody is changed or removed."""

import hashlib
import logging
from collections.abc import Iterable
from dataclasses import dataclass

from grader.contracts.errors import CourseError, RefusedError
from grader.contracts.identity import Caller, RosterEntry, Seen, checked_entry, is_person_id
from grader.contracts.platform import Platform
from grader.outside.lti.roster import Listed
from grader.outside.lti.scores import NotTakenError
from grader.outside.signin import SignInError
from grader.outside.signin.channel import UnreachableError
from grader.use_cases.callers import taught_course
from grader.use_cases.services import Services

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, kw_only=True)
class PeoplePlan:
    """The people whom an import from a platform adds.

    Attributes:
        added: students whom the course does not have, in order of id.
        known: how many it has.
        nameless: students there without an id that can stand in a class list, or with one that another has, too,
            by their names.
        others: how many there are no students.
    """

    platform: Platform
    added: tuple[RosterEntry, ...]
    known: int
    nameless: tuple[str, ...]
    others: int

    @property
    def tag(self) -> str:
        """Return a digest of the people whom this plan adds."""
        return hashlib.sha256(repr(self.added).encode()).hexdigest()[:16]


def plan(services: Services, caller: Caller, platform_id: str) -> PeoplePlan:
    """Ask a platform who is in its course; return whom the caller's course lacks. Nothing is changed.

    Raises:
        RefusedError: the caller is no instructor, there is no such platform, it has not said where it tells its
            people, or does not tell them.
    """
    course = taught_course(caller)
    platform = services.platforms.get(platform_id)
    if platform is None or platform.course != course:
        raise RefusedError("platform_not_found")
    if not platform.people_url:
        raise RefusedError("platform_tells_nobody")
    try:
        with services.allowances.sign_ins.one_more(platform.provider):
            listed = services.platform_channel.people(platform)
    except (NotTakenError, UnreachableError, SignInError) as error:
        _log.warning("the people of %s: %s", platform.title, error)
        raise RefusedError("platform_people_refused") from None
    return _planned(services, platform, listed)


def add(services: Services, caller: Caller, platform_id: str, seen: Seen) -> PeoplePlan:
    """Take the people in whom `plan` shows; return whom that added.

    Raises as `plan`, or the plan is not the one that was `seen`.
    """
    planned = plan(services, caller, platform_id)
    if not seen.includes(planned.tag):
        raise RefusedError("changed_meanwhile")
    if planned.added:
        services.courses.import_roster(planned.platform.course, planned.added, caller.signature)
    return planned


def _planned(services: Services, platform: Platform, listed: Iterable[Listed]) -> PeoplePlan:
    here = {member.id.casefold() for member in services.courses.members(platform.course)}
    bound = services.identities.subjects(platform.provider)
    added: dict[str, tuple[str, RosterEntry]] = {}  # with the platform's name for the person
    taken: set[str] = set()
    nameless, enrolled, others = [], 0, 0
    for entry in listed:
        person = next((claim for claim in entry.claimed if is_person_id(claim)), None)
        if not entry.learns:
            others += 1
        elif entry.subject in bound or any(claim.casefold() in here for claim in entry.claimed):
            enrolled += 1
        elif person is None or (key := person.casefold()) in taken:
            nameless.append(entry.name or entry.subject)
        elif added.get(key, (entry.subject,))[0] != entry.subject:
            taken.add(key)
            nameless += [added.pop(key)[1].name or person, entry.name or entry.subject]
        else:
            added.setdefault(key, (entry.subject, _entry(person, entry)))
    ordered = tuple(added[key][1] for key in sorted(added))
    return PeoplePlan(
        platform=platform, added=ordered, known=enrolled, nameless=tuple(sorted(nameless)), others=others
    )


def _entry(person: str, one: Listed) -> RosterEntry:
    """Return the line of a class list; a name or an address that cannot stand in one is left out."""
    for name, email in ((one.name, one.email), (one.name, ""), ("", "")):
        try:
            return checked_entry(RosterEntry(id=person, name=name, email=email or None))
        except CourseError:
            continue
    return RosterEntry(id=person, name="")
