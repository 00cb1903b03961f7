"""Numbers that come out wrong: what division and ``int()`` drop, degrees for radians, whole numbers for floats."""

import math
import re
from collections.abc import Iterator
from typing import Final

from grader.checks.causes.searched import CLOCK, Searched, itself
from grader.checks.drive import FAST_TURN_RADPS, fastest_radps
from grader.checks.measure import Mistake, mistake
from grader.messages.arithmetic import value_of
from grader.messages.quantity import exact, number
from grader.messages.script import ScriptText

_INNER: Final = r"([^()\n]*(?:\([^()]*\)[^()\n]*)*)"
"""The argument of a call. It may contain brackets, side by side, but none within others."""
_WHOLE: Final = r"(?<![\w.])(?<![*/%)\]])(?<![*/%)\]] )([\w.]+) ?// ?([\w.]+)(?![\w.(])"
"""A division with ``//`` of two names or numbers that is not part of a longer product or quotient."""
_TIME: Final = r"(?i)(time|dur|sec(?!ond_)|shijian|miao|时间|秒)"
_BESIDE_CUT: Final = 0.03  # an update of turtlesim, and one of the script's own loop
_CUT: Final = 0.01
_RADIANS: Final = 6.3  # more is meant as degrees
_TOLERANCE: Final = 0.03  # of 15 degrees
_RATE_RADPS: Final = 2.0  # of what turns faster, a few degrees a second are more likely to be meant
_RATE: Final = r"(?i)angular\.z ?=|\w*(speed|omega|rate|vel)\w* ?="


def floor_is_zero(seen: Searched) -> Mistake | None:
    """Find a division with ``//`` whose result is 0."""
    for line, found in seen.script.matches(_WHOLE):
        share = _quotient(found[1], found[2], seen.script)
        if share is not None and 0.0 < share < 1.0:
            return mistake("floor_is_zero", line=line, written=found[0])
    return None


def _quotient(above: str, below: str, script: ScriptText) -> float | None:
    one, other = value_of(above, script), value_of(below, script)
    return one / other if one is not None and other else None


def int_is_zero(seen: Searched) -> Mistake | None:
    """Find an ``int(...)`` that makes 0 of a speed or a time."""
    for line, found in seen.script.matches(rf"\bint\({_INNER}\)"):
        value = value_of(found[1], seen.script)
        if value is not None and 0.0 < abs(value) < 1.0:
            return mistake("int_is_zero", line=line, written=found[0], value=exact(value))
    return None


def negative_time(seen: Searched) -> Mistake | None:
    """Find a time that comes out negative because of a negative speed, in a script without ``abs()``."""
    if seen.script.lines_with(r"\bf?abs\("):
        return None
    for line, found in seen.script.matches(r"^[ \t]*((?:self\.)?\w+) ?=(?!=)(.*/.*)$"):
        value = value_of(found[2].strip(), seen.script) if re.search(_TIME, found[1]) else None
        if value is not None and value < 0.0:
            return mistake("negative_time", line=line, name=found[1], value=number(value, "s"))
    for line, found in seen.script.matches(rf"^(?![ \t]*def\b).*?(\w+)\({_INNER}\)"):
        made = seen.script.definition(found[1])
        given = seen.script.arguments(line, found[1]) if made else []
        if len(given) > 1 and all(value_of(one, seen.script) in (0.0, None) for one in given[:-1]):
            continue  # a pause
        for place, written in enumerate(given):
            value = value_of(written, seen.script)
            if made and value is not None and value < 0.0 and _is_time(made.line, place, seen.script):
                return mistake("negative_time", line=line, name=written, value=number(value, "s"))
    return None


def _is_time(begins: int, place: int, script: ScriptText) -> bool:
    """Whether a function waits for as long as the argument at that place says."""
    inside = script.lines[begins - 1].partition("(")[2].removeprefix("self").lstrip(" ,").partition(")")[0]
    names = [part.partition("=")[0].partition(":")[0].strip() for part in inside.split(",")]
    name = rf"(?<!abs\(){itself(names[place])}" if place < len(names) and names[place] else None
    limit = rf"{CLOCK}.*{name}|{name}.*{CLOCK}|\bwhile\b.*[<>]=? ?{name}|\brange\(.*{name}"
    block = script.block(begins)[1:]
    if name is None or any(re.search(rf"{name} ?[-*]?=(?!=)", text) for text in block):
        return False  # it may be made positive
    return any(re.search(limit, text) for text in block)


def ticks_cut(seen: Searched) -> Mistake | None:
    """Find a number of ticks that ``int()`` or ``//`` cut by more than a hundredth."""
    for line in seen.script.lines_with(r"\bint\(|//"):
        text = seen.script.lines[line - 1]
        cut = [
            (found[0], value_of(found[1], seen.script)) for found in re.finditer(rf"\bint\({_INNER}\)", text)
        ]
        cut += [(found[0], _quotient(found[1], found[2], seen.script)) for found in re.finditer(_WHOLE, text)]
        for written, value in cut:
            share = 0.0 if value is None or value <= 1.0 else (value - math.floor(value)) / value
            if value is not None and share > _CUT and _explains(share, seen):
                values = {"value": exact(value), "whole": math.floor(value)}
                return mistake("ticks_cut", line=line, written=written, **values)
    return None


def _explains(share: float, seen: Searched) -> bool:
    """Whether the worst corner lacks no more than a cut of that share takes away, or is not known."""
    if seen.corner_deg is None:
        return True
    corner_deg, wanted_deg = seen.corner_deg
    return (wanted_deg - corner_deg) / wanted_deg <= share + _BESIDE_CUT


def radians_twice(seen: Searched) -> Mistake | None:
    """Find ``math.radians`` of an angle that is in radians already."""
    for line, found in _calls_of("radians", seen.script):
        if _in_radians(found[1], seen.script.lines[line - 1], seen.script):
            return mistake("radians_twice", line=line, written=found[0], inner=found[1].strip())
    return None


def radians_of_pose(seen: Searched) -> Mistake | None:
    """Find ``math.radians`` of a pose's theta, or of ``math.atan2``."""
    for line, found in _calls_of("radians", seen.script):
        if re.search(r"\b(info|debug|warn|warning|print)\(", found.string):
            continue  # what is only shown moves nothing
        if _angle_of_pose(found[1], seen.script) or re.fullmatch(r"(?:math\.)?atan2\(.*\)", found[1].strip()):
            return mistake("radians_twice", line=line, written=found[0], inner=found[1].strip())
    return None


def _calls_of(function: str, script: ScriptText) -> Iterator[tuple[int, re.Match[str]]]:
    """Yield the line number and the match of each call of a conversion; the match's group is the argument."""
    return script.matches(rf"\b(?:math\.)?{function}\({_INNER}\)")


def _in_radians(written: str, line: str, script: ScriptText) -> bool:
    """Whether an expression is an angle in radians, or a rate; a few degrees may be meant as a tolerance."""
    value = value_of(written, script)
    if value is None:
        return re.search(r"\bpi\b", written) is not None and not re.search(r"180|degrees", written)
    parts = abs(value) / (math.pi / 12)
    of_circle = round(parts) >= 1 and abs(parts - round(parts)) < _TOLERANCE
    of_rate = abs(value) <= _RATE_RADPS and re.search(_RATE, line) is not None
    return 0.0 < abs(value) < _RADIANS and (of_circle or of_rate)


def _angle_of_pose(written: str, script: ScriptText) -> bool:
    """Whether an expression is a pose's theta, in a script that nowhere sets a theta in degrees."""
    converted = r"theta\w* *=.*(?:\b180|degrees\(|\b57\.\d)"
    return re.fullmatch(r"[\w.]+\.theta", written.strip()) is not None and not script.lines_with(converted)


def degrees_for_radians(seen: Searched) -> Mistake | None:
    """Find ``math.degrees`` of an angle that is in degrees already."""
    for line, found in _calls_of("degrees", seen.script):
        value = value_of(found[1], seen.script)
        if value is not None and abs(value) > 2 * _RADIANS:
            return mistake("degrees_for_radians", line=line, written=found[0], inner=found[1].strip())
    return None


def degrees_of_radians(seen: Searched) -> Mistake | None:
    """Find an angle in degrees from which theta is subtracted, or that sets a turn rate nobody would choose."""
    script = seen.script
    is_too_fast = fastest_radps(seen.run) >= FAST_TURN_RADPS
    for line, found in _calls_of("degrees", script):
        before, after = found.string[: found.start()], found.string[found.end() :]
        beside = re.match(r" *- *([\w.]+)(?![\w.(]| *[*/])", after)
        mixed = beside is not None and _angle_of_pose(beside[1], script)
        if (
            mixed
            or (re.search(r"\batan2\([^()]*\) ?- ?$", before) and re.search(r"\.theta\b", found[0]))
            or _less_theta(before, after, script)
            or (is_too_fast and _becomes_rate(before, after, script))
        ):
            return mistake("degrees_of_radians", line=line, written=found[0])
    return None


def _less_theta(before: str, after: str, script: ScriptText) -> bool:
    """Whether a line gives a variable an angle in degrees, from which another one takes theta; as below."""
    assigned = re.fullmatch(r"\s*([\w.]+) *= *", before)
    if assigned is None or after.strip():
        return False
    beside = (
        found[1] for _, found in script.matches(rf"{itself(assigned[1])} *- *([\w.]+)(?![\w.(]| *[*/])")
    )
    return any(_angle_of_pose(one, script) for one in beside)


def _becomes_rate(before: str, after: str, script: ScriptText) -> bool:
    """Whether a line computes a variable from a call, with more than the call, and ``angular.z`` from that.

    Args:
        before: the line's text on the left of the call.
        after: that on the right.
        script: the whole script.
    """
    assigned = re.fullmatch(r"\s*([\w.]+) *= *", before)
    if assigned is None or re.fullmatch(r"\s*(?:#.*)?", after) is None:
        return False
    name = re.escape(assigned[1])
    return bool(script.lines_with(rf"angular\.z *=[^#(]*(?<![\w.]){name}(?![\w.(])"))
