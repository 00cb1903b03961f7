"""Steering by the pose: directions, distances and angles that are computed or compared wrongly."""

import math
import re
from typing import Final

from grader.checks.causes.searched import Searched, itself
from grader.checks.measure import Mistake, mistake
from grader.messages.arithmetic import value_of
from grader.messages.quantity import exact, number
from grader.messages.script import ScriptText

_CONDITION: Final = r"\b(?:if|elif|while)\b.*?"
# The name is bounded: searching a hostile one would take long.
_ANGLE: Final = r"[\w.]{0,40}(?:err|diff|delta|angle|theta|yaw)\w{0,40}"
_MEASURED: Final = (
    r"(?<![\w.])([\w.]{0,40}(?:dist|err|angle|theta|yaw|diff|delta|pose\.[xy])\w{0,40}|d)(?![\w.])"
)
_KEEPS_DEGREES: Final = (
    r"\b(degrees|rad2deg)\(|\b(radians|deg2rad)\( ?[a-zA-Z_]"
    r"|\b180\b.*(\b(?i:pi)\b|\b3\.14)|(\b(?i:pi)\b|\b3\.14).*\b180\b|\b57\.\d|\b0?\.0174\d*"
)
_PLUS_DEGREES: Final = (
    r"(?:theta|heading|yaw)\w{0,40} ?[-+]=? ?(?=\d\d)"
    r"|(?:target|goal|wanted|angle)\w{0,40} ?[-+]=? ?(?=(?:45|60|72|90|120)\b)"
)
_COASTED_DEG: Final = 2.0
_WIDE_RAD: Final = 0.08  # almost 5 degrees, which cost points at each corner
_VERY_WIDE_RAD: Final = 0.2
LATER: Final = frozenset(("arcs_by_pose", "crooked", "approach", "turned_on"))
"""What comes of a turn that ends early: the rest is turned while driving, or the figure begins at the next one."""
_LEAST_M: Final = 0.01  # poses come every 16 ms: at 1 m/s the car drives more than that in between
_ALONG_X: Final = r"((?:self\.)?(?:d|delta_?|error_?|err_?|diff_?)x|[\w.]*x ?- ?[\w.]*x)"
_ALONG_Y: Final = _ALONG_X.replace("x", "y")
"""A difference along an axis: ``dx``, or ``goal_x - self.pose.x``."""
_TERM: Final = r"(?:math\.)?atan2\([^()]*\)|[\w.]{1,60}"
_PRESENT: Final = r"(?i)(?:theta|yaw)$"
_WANTED: Final = r"(?i)target|goal|want|desire|aim|ref|dest|next|end"


def equals_exactly(seen: Searched) -> Mistake | None:
    """Find a distance or an angle that must equal a number exactly."""
    for line, found in seen.script.matches(rf"{_CONDITION}{_MEASURED} ?(==|!=) ?([\w.]+)"):
        name, sign, value = found.groups()
        body = [text for _, text in seen.script.body(line)]
        if all(re.match(rf"(return|continue)$|{re.escape(name)} ?=(?!=)", text) for text in body) and body:
            continue  # a guard: against a pose that has not come, or a division by 0
        made = seen.script.definition(seen.script.function_around(line))
        if made is not None and re.search(itself(name), seen.script.lines[made.line - 1]):
            continue  # a parameter, as it was written in the call
        if value in ("None", "True", "False") or name in seen.script.counters:
            continue
        if not _is_flag(name, seen.script):
            return mistake("equals_exactly", line=line, written=f"{name} {sign} {value}", name=name)
    return None


def _is_flag(name: str, script: ScriptText) -> bool:
    """Whether a name is assigned nothing but whole numbers, which may be compared exactly."""
    given = [found[1].strip() for _, found in script.matches(rf"{itself(name)} ?=(?!=)(.*)$")]
    return bool(given) and all(re.fullmatch(r"-?\d+|True|False|.*[^-=][<>].*", value) for value in given)


def degrees_added(seen: Searched) -> Mistake | None:
    """Find degrees that are added to a heading in radians: the script converts no heading to degrees."""
    if seen.script.lines_with(_KEEPS_DEGREES):
        return None
    added = rf"(?i)(?<![\w.])[\w.]{{0,40}}(?:{_PLUS_DEGREES})(\d{{2,3}})(?:\.0*)?(?![\w.]| ?[*/])"
    for line, found in seen.script.matches(added):
        return mistake("degrees_added", line=line, written=found[0], degrees=found[1])
    return None


def wide_tolerance(seen: Searched) -> Mistake | None:
    """Find a condition that ends a turn while many degrees are still missing."""
    differences = r"(?:[\w.]{1,60}\()?[^()]{0,80}\btheta\b[^()]{0,40}\)?"
    compared = list(
        seen.script.matches(rf"{_CONDITION}\babs\( ?(?:{_ANGLE}|{differences}) ?\) ?(?:<=?|>=?) ?([\w.]+)")
    )
    known = [value for _, found in compared if (value := value_of(found[1], seen.script)) is not None]
    if any(value < _WIDE_RAD for value in known):
        return None  # that one ends the turn; the others slow it down
    for line, found in compared:
        rad = value_of(found[1], seen.script)
        if rad is None or not _WIDE_RAD <= rad <= math.pi / 2:
            continue
        if rad >= _VERY_WIDE_RAD if seen.mistake.code in LATER else _misses_by(math.degrees(rad), seen):
            degrees = number(math.degrees(rad), "deg")
            return mistake("wide_tolerance", line=line, value=number(rad, "rad"), degrees=degrees)
    return None


def _misses_by(tolerance_deg: float, seen: Searched) -> bool:
    """Whether the tolerance explains the error of the worst corner; true if no corner was measured."""
    if seen.corner_deg is None:
        return True
    corner_deg, wanted_deg = seen.corner_deg
    return 0.0 < wanted_deg - corner_deg <= tolerance_deg + _COASTED_DEG


def tolerance_too_small(seen: Searched) -> Mistake | None:
    """Find a tolerance of a distance smaller than the way that the car drives between two poses."""
    distance = r"(?<![\w.])((?:self\.)?\w*(?:dist|juli|err|距离)\w*)"
    for line, found in seen.script.matches(rf"{_CONDITION}{distance} ?(?:<=?|>=?) ?([\w.]+)"):
        value = value_of(found[2], seen.script)
        if re.search(r"(?i)ang|theta|yaw|head", found[1]):
            continue  # no distance
        if value is not None and 0.0 <= value <= _LEAST_M:
            return mistake("tolerance_too_small", line=line, name=found[1], value=exact(value))
    return None


def arctan_exchanged(seen: Searched) -> Mistake | None:
    """Find a direction that is computed with x and y exchanged."""
    for line, found in seen.script.matches(rf"\batan2\( ?{_ALONG_X} ?, ?{_ALONG_Y} ?\)"):
        return mistake("arctan_exchanged", line=line, written=found[0], first=found[2], second=found[1])
    return None


def away_from_goal(seen: Searched) -> Mistake | None:
    """Find a direction that is computed from the goal to the car instead of from the car to the goal."""
    for axis, place in (("x", r"[^()]*, ?{name} ?\)"), ("y", r" ?{name} ?,")):
        for line, found in seen.script.matches(rf"^[ \t]*([\w.]+) ?= ?([\w.]*pose\.{axis}) ?- ?([^-+]+)$"):
            name, near, far = (part.strip() for part in found.groups())
            used = rf"\batan2\({place.format(name=itself(name))}"
            if "pose" not in far and seen.script.lines_with(used):
                return mistake("away_from_goal", line=line, right=f"{name} = {far} - {near}")
    return None


def turns_away(seen: Searched) -> Mistake | None:
    """Find an error of the heading that has the car turn away from where it should look.

    The error is wanted less present, and the turn rate has its sign: one of the two is the other way round.
    """
    script = seen.script
    if (plain := _turned_away(script)) is not None:
        return plain
    for line, found in script.matches(
        rf"^[ \t]*([\w.]+) ?=(?!=).*?(?<![\w.])({_TERM}) ?- ?({_TERM})(?![\w.(])"
    ):
        name, first, second = found.groups()
        present = [bool(re.search(_PRESENT, one)) and not re.search(_WANTED, one) for one in (first, second)]
        if sum(present) != 1 or re.search(r"- ?\($|- ?$|-\w+\.?\w*\($", found.string[: found.start(2)]):
            continue
        turned = script.matches(rf"\.angular\.z ?=(?!=) ?([^=]*{itself(name)}.*)$")
        signs = [(at, sign) for at, one in turned if (sign := _sign(one[1], name))]
        wrong = [at for at, sign in signs if sign == (1 if present[0] else -1)]
        if wrong:
            at = line if present[0] and len(wrong) == len(signs) else wrong[0]
            return mistake("turns_away", line=at, name=name, wanted=(first, second)[present[0]])
    return None


def _turned_away(script: ScriptText) -> Mistake | None:
    """Find a turn rate that is computed at once, from the present heading less the wanted one."""
    factor = r"(?:[\w.]{1,40} ?\* ?)?(?:[\w.]{1,40})?"
    rate = rf"\.angular\.z ?= ?{factor}\(? ?({_TERM}) ?- ?({_TERM}) ?\)?(?: ?\* ?[\w.]+)?$"
    for line, found in script.matches(rate):
        present = [bool(re.search(_PRESENT, one)) and not re.search(_WANTED, one) for one in found.groups()]
        if present == [True, False]:
            return mistake("turns_away", line=line, name="e", wanted=found[2])
    return None


def _sign(written: str, name: str) -> int:
    """Return the sign of a turn rate for a positive error: 1 or -1, or 0 where that is not plain."""
    error, factor = itself(name), r"[\w.]+"
    limited = re.fullmatch(r"(?:max|min)\([^(),]*, ?(?:max|min)\([^(),]*, ?([^,]*)\) ?\)", written)
    written = written if limited is None else limited[1].strip()
    if re.fullmatch(
        rf"(?:{factor} ?\* ?)?{error}(?: ?\* ?{factor})?|{factor} if {error} ?>.* else ?- ?{factor}", written
    ):
        return 1
    against = rf"- ?(?:{factor} ?\* ?)?{error}(?: ?\* ?{factor})?|- ?{factor} if {error} ?>.* else {factor}"
    return -1 if re.fullmatch(against, written) else 0


def quaternion_for_yaw(seen: Searched) -> Mistake | None:
    """Find a component of a quaternion that is taken for a heading."""
    heading = r"(?i)(?<![\w.])[\w.]{0,40}(?:theta|yaw|heading|angle)\w{0,40}"
    part = r"((?:[\w.]*\b(?:orientation|quat\w*|ori|q|o))\.[zw])"
    taken = rf"{heading} ?= ?{part} *$"
    for line, found in seen.script.matches(taken):
        return mistake("quaternion_for_yaw", line=line, written=found[1])
    return None
