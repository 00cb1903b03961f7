"""Scripts of a class with common passages that few others have, or that drove alike: for staff to look at.

Nothing of it is stored, and no score depends on it.
"""

import gzip
import hashlib
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from grader.contracts.assignment import Assignment
from grader.contracts.errors import RefusedError
from grader.contracts.identity import Caller
from grader.contracts.trajectory import decode_commands
from grader.formats.packages.bundle import code_of
from grader.similarity.commands import SentCommands, drive_of
from grader.similarity.fingerprints import Fingerprints, Hashes, fingerprints, grams
from grader.similarity.ranking import Pair, Script, rank
from grader.similarity.tokens import tokens_of
from grader.store.scripts import HandedIn
from grader.use_cases.assignments import published, require_published
from grader.use_cases.callers import require_staff
from grader.use_cases.comparing import Similar, SimilarPair
from grader.use_cases.services import Services

MOST_SCRIPTS = 1_000
"""Most scripts that are compared at once; of a larger class those handed in last."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SideBySide:
    """Two similar scripts with their texts."""

    pair: SimilarPair
    first_source: bytes
    second_source: bytes


async def similar(services: Services, caller: Caller, assignment_id: str) -> Similar:
    """Return which scripts of the caller's class are alike.

    Raises RefusedError: the caller may not see the class, there is no such assignment, or it asks for texts.
    """
    require_staff(caller)
    return await services.comparer.run(lambda: _shown(caller, _similar(services, caller, assignment_id)))


async def side_by_side(
    services: Services, caller: Caller, assignment_id: str, first: str, second: str
) -> SideBySide:
    """Return two scripts by the ids of their submissions, in either order.

    Raises as `similar`, or these two are not, or no longer, among the similar ones.
    """
    require_staff(caller)

    def read() -> SideBySide:
        whole = _shown(caller, _similar(services, caller, assignment_id))
        for pair in (*whole.pairs, *whole.same_drives):
            if {pair.first.submission, pair.second.submission} == {first, second}:
                sources = dict(services.comparer.scripts.sources({pair.first.sha256, pair.second.sha256}))
                return SideBySide(
                    pair=pair,
                    first_source=sources[pair.first.sha256],
                    second_source=sources[pair.second.sha256],
                )
        raise RefusedError("submission_not_found")

    return await services.comparer.run(read)


def _shown(caller: Caller, similar: Similar) -> Similar:
    """Return the pairs of students whom the caller looks after; they are compared with the whole class."""
    if caller.students is None:
        return similar

    def own(pairs: Sequence[SimilarPair]) -> tuple[SimilarPair, ...]:
        return tuple(
            pair
            for pair in pairs
            if caller.looks_after(pair.first.student) and caller.looks_after(pair.second.student)
        )

    return replace(
        similar,
        too_little=tuple(script for script in similar.too_little if caller.looks_after(script)),
        pairs=own(similar.pairs),
        same_drives=own(similar.same_drives),
    )


def is_compared(assignment: Assignment | None) -> bool:
    """Whether what is handed in for an assignment is compared: texts are not. None: it is no longer published."""
    return assignment is None or assignment.input != "text"


def _similar(services: Services, caller: Caller, assignment_id: str) -> Similar:
    state = services.dashboard.state(caller.course)
    own = [cell for cell in state.progress if cell.assignment == assignment_id]
    look = published if own else require_published
    assignment = look(services, caller, assignment_id)
    if not is_compared(assignment):
        raise RefusedError("no_scripts")
    latest = sorted(own, key=lambda one: (one.last_activity_at, one.student), reverse=True)[:MOST_SCRIPTS]
    every = services.comparer.scripts.of(
        [cell.counted_submission or cell.latest_submission for cell in latest]
    )
    scripts = tuple({script.team_upload or script.submission: script for script in reversed(every)}.values())[
        ::-1
    ]
    teams = services.teams.of(caller.course, assignment_id)
    mates = {person: team.code for team in teams for person in team.members}
    staff = services.comparer.scripts.of_staff(caller.course, assignment_id)
    given_code = services.assignments.of(caller.course).given_code()
    key = (caller.course, assignment_id, scripts, staff, _digest(given_code), len(own))
    kept = services.comparer.results.find(key)
    if kept is None:
        compared = _compared(services, assignment_id, scripts, staff, given_code)
        kept = services.comparer.results.keep(key, replace(compared, not_compared=len(own) - len(every)))
    return _without_mates(kept, mates)


def _without_mates(similar: Similar, team_of: Mapping[str, str]) -> Similar:
    """Leave out the pairs of students who are in one team."""
    if not team_of:
        return similar

    def of_two(pairs: Sequence[SimilarPair]) -> tuple[SimilarPair, ...]:
        teams = ((team_of.get(pair.first.student), team_of.get(pair.second.student), pair) for pair in pairs)
        return tuple(one for first, second, one in teams if first is None or first != second)

    return replace(similar, pairs=of_two(similar.pairs), same_drives=of_two(similar.same_drives))


def _compared(
    services: Services,
    assignment_id: str,
    scripts: tuple[HandedIn, ...],
    staff: tuple[HandedIn, ...],
    given: Sequence[bytes],
) -> Similar:
    prints, drives = _fingerprints(services, scripts), _drives(services, (*scripts, *staff))
    ranking = rank(
        [Script(script.sha256, prints[script.sha256], drives.get(script.submission)) for script in scripts],
        _grams(services, staff, given),
        frozenset(drives[script.submission].digest for script in staff if script.submission in drives),
    )

    def pairs(found: Sequence[Pair]) -> tuple[SimilarPair, ...]:
        return tuple(SimilarPair(scripts[pair.first], scripts[pair.second], pair) for pair in found)

    return Similar(
        assignment=assignment_id,
        compared=len(scripts) - len(ranking.too_little),
        not_compared=0,
        few=ranking.few,
        too_little=tuple(scripts[i].student for i in ranking.too_little),
        pairs=pairs(ranking.pairs),
        left_out=ranking.left_out,
        same_drives=pairs(ranking.same_drives),
    )


def _grams(services: Services, staff: Collection[HandedIn], given: Sequence[bytes]) -> Hashes:
    """Return every run of tokens in the code that all were given; what staff handed in is such code."""
    handed_in = {script.sha256 for script in staff}
    key = (frozenset(handed_in), _digest(given))
    kept = services.comparer.grams.find(key)
    if kept is not None:
        return kept
    theirs = [source for _, source in services.comparer.scripts.sources(handed_in)]
    every = [grams(tokens_of(code_of(script))) for script in (*given, *theirs)]
    common = np.unique(np.concatenate([np.zeros(0, dtype=np.uint64), *every]))
    return services.comparer.grams.keep(key, common)


def _fingerprints(services: Services, scripts: Collection[HandedIn]) -> dict[str, Fingerprints]:
    """Return what is compared of files, by their digests."""
    kept = services.comparer.fingerprints
    digests = {script.sha256 for script in scripts}
    known_prints = {digest: known for digest in digests if (known := kept.find(digest)) is not None}
    for sha256, source in services.comparer.scripts.sources(digests - known_prints.keys()):
        known_prints[sha256] = kept.keep(sha256, fingerprints(tokens_of(code_of(source))))
    return known_prints


def _drives(services: Services, scripts: Collection[HandedIn]) -> dict[str, SentCommands]:
    """Return by submission how the scripts drove that were graded."""
    kept = services.comparer.drives
    known_prints = {script: known for script in scripts if (known := kept.find(script)) is not None}
    for one, runs in services.comparer.scripts.recordings(
        [script for script in scripts if script not in known_prints]
    ):
        known_prints[one] = kept.keep(one, drive_of(decode_commands(gzip.decompress(run)) for run in runs))
    return {one.submission: drive for one, drive in known_prints.items()}


def _digest(files: Sequence[bytes]) -> bytes:
    return hashlib.sha256(b"".join(hashlib.sha256(file).digest() for file in files)).digest()
