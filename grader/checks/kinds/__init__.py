"""The kinds of checks, one module each, and the tables in which they are registered.

They do not know each other: import-linter holds every module in this folder to it.
"""

from collections.abc import Mapping

from grader.checks.kinds import (
    bodies,
    conversation,
    essay,
    motion,
    number,
    path,
    places,
    polygon,
    room,
    rotation,
)
from grader.checks.measure import Check, Kind, TextCheck

CHECKS: Mapping[str, Check] = {
    check.kind: check
    for check in (
        conversation.CHECK,
        motion.CHECK,
        rotation.CHECK,
        polygon.CHECK,
        path.CHECK,
        places.CHECK,
        room.CHECK,
        bodies.CHECK,
    )
}
TEXT_CHECKS: Mapping[str, TextCheck] = {check.kind: check for check in (number.CHECK, essay.CHECK)}
KINDS: Mapping[str, Kind] = {**CHECKS, **TEXT_CHECKS}
OLDER_NAMES: Mapping[str, str] = dict.fromkeys(("node", "service", "agent"), "conversation")
"""What checks were called before, in assignments that are stored."""
