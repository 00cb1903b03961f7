"""Why a mistake happened: the line of the script that should be changed.

A check knows only what the car did, and a mistake's code says no more: *sides missing*, *only stops*. Often one
line of the script explains it. `with_causes` then puts that cause in the mistake's place. Each cause names the
mistakes that it can lead to, so a line that did no harm is never mentioned. Where the script does not show the
cause for certain, the mistake stays as it was.
"""

import itertools
import math
import re
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Final, NamedTuple

from grader.checks.drive import FAST_TURN_RADPS, fastest_radps
from grader.checks.measure import Findings, Mistake, mistake
from grader.checks.mistakes import not_called, sleep_at_horizon, sleeps_too_long
from grader.contracts.assignment import Assignment
from grader.contracts.outcome import RunStatus
from grader.contracts.scoring import Run
from grader.messages.arithmetic import value_of
from grader.messages.quantity import exact, number
from grader.messages.script import ScriptText


class Searched(NamedTuple):
    """A run with its script, and what was measured and recognised in it."""

    assignment: Assignment
    run: Run
    script: ScriptText
    findings: Findings
    mistake: Mistake


def with_causes(assignment: Assignment, run: Run, findings: Findings) -> Findings:
    """Return the findings with each mistake replaced by the cause that the script shows, where it shows one."""
    script = ScriptText(run.source)
    if not script.is_short:
        return findings
    causes = tuple(_cause(Searched(assignment, run, script, findings, each)) for each in findings.mistakes)
    return replace(findings, mistakes=causes)


def _cause(seen: Searched) -> Mistake:
    for codes, look in _CAUSES:
        if seen.mistake.code in codes and (cause := look(seen)) is not None:
            return Mistake(cause.code, cause.text, seen.mistake.measures, seen.mistake.apart)
    return seen.mistake


# ------------------------------------------------------------------------------- numbers that come out wrong


_INNER: Final = r"([^()\n]*(?:\([^()]*\)[^()\n]*)*)"
"""What stands between two brackets, with at most one pair of brackets inside."""


def _floor_is_zero(seen: Searched) -> Mistake | None:
    """Find a division with ``//`` whose result is 0."""
    for line in seen.script.lines_with(r"//"):
        for found in re.finditer(_WHOLE, seen.script.lines[line - 1]):
            share = _quotient(found[1], found[2], seen.script)
            if share is not None and 0.0 < share < 1.0:
                return mistake("floor_is_zero", line=line, written=found[0])
    return None


_WHOLE: Final = r"(?<![\w.])(?<![*/%)\]])(?<![*/%)\]] )([\w.]+) ?// ?([\w.]+)(?![\w.(])"
"""A division with ``//`` of two names or numbers, and not of what is multiplied or divided before."""


def _quotient(above: str, below: str, script: ScriptText) -> float | None:
    one, other = value_of(above, script), value_of(below, script)
    return one / other if one is not None and other else None


def _int_is_zero(seen: Searched) -> Mistake | None:
    """Find an ``int(...)`` that makes 0 of a speed or a time."""
    for line in seen.script.lines_with(r"\bint\("):
        for found in re.finditer(rf"\bint\({_INNER}\)", seen.script.lines[line - 1]):
            value = value_of(found[1], seen.script)
            if value is not None and 0.0 < abs(value) < 1.0:
                return mistake("int_is_zero", line=line, written=found[0], value=exact(value))
    return None


_TIME: Final = r"(?i)(time|dur|sec(?!ond_)|shijian|miao|时间|秒)"


def _negative_time(seen: Searched) -> Mistake | None:
    """Find a time that is divided by a negative speed, in a script that takes no amounts."""
    if seen.script.lines_with(r"\bf?abs\("):
        return None
    for line in seen.script.lines_with(r"^[ \t]*(self\.)?\w+ ?=(?!=).*/"):
        name, _, written = seen.script.lines[line - 1].strip().partition("=")
        value = value_of(written.strip(), seen.script) if re.search(_TIME, name) else None
        if value is not None and value < 0.0:
            return mistake("negative_time", line=line, name=name.strip(), value=number(value, "s"))
    return None


def _ticks_cut(seen: Searched) -> Mistake | None:
    """Find a number of ticks that ``int()`` or ``//`` cut by more than a hundredth."""
    for line in seen.script.lines_with(r"\bint\(|//"):
        text = seen.script.lines[line - 1]
        cut = [
            (found[0], value_of(found[1], seen.script)) for found in re.finditer(rf"\bint\({_INNER}\)", text)
        ]
        cut += [(found[0], _quotient(found[1], found[2], seen.script)) for found in re.finditer(_WHOLE, text)]
        for written, value in cut:
            if value is not None and value > 1.0 and (value - math.floor(value)) / value > _CUT:
                values = {"value": number(value, ""), "whole": math.floor(value)}
                return mistake("ticks_cut", line=line, written=written, **values)
    return None


_CUT: Final = 0.01


def _counts_ticks(seen: Searched) -> Mistake | None:
    """Find a count of a timer's ticks whose limit is reached much too early."""
    timers = seen.script.callbacks("timer")
    if len(timers) != 1:
        return None
    made = re.search(r"create_timer\( ?([^,()]+),", seen.script.lines[timers[0][0] - 1])
    period_s = value_of(made[1].strip(), seen.script) if made else None
    begins = seen.script.definition(timers[0][1])
    if period_s is None or begins is None or not 0.0 < period_s < 1.0:
        return None
    for line, text in enumerate(seen.script.block(begins.line), start=begins.line):
        found = re.search(r"\bif ([\w.]+) ?(<=?|>=?|==) ?([\w.]+) ?:", text)
        counted = found and _counted_each_tick(found[1], seen.script)
        count = value_of(found[3], seen.script) if found and counted else None
        if found and count and count >= 1 and (count * period_s <= _EARLY_S or count <= _FEW_TICKS):
            took = number(count * period_s, "s")
            values = {"name": found[1], "count": f"{count:g}", "period": number(period_s, "s"), "took": took}
            return mistake("counts_ticks", line=line, **values)
    return None


def _counted_each_tick(name: str, script: ScriptText) -> bool:
    """Whether a name is raised by 1 at each tick: not only when another count has come somewhere, as sides are."""
    others = "|".join(re.escape(other) for other in script.counters - {name})
    for line in script.lines_with(rf"(?<![\w.]){_raising(name)}\s*$"):
        conditions = [script.lines[line - 1].rpartition(":")[0], *script.conditions_of(line)]
        if not others or not re.search(rf"(?<![\w.])({others})\b", " ".join(conditions)):
            return True
    return False


def _raising(name: str) -> str:
    """Return the pattern of what raises a name by 1."""
    return rf"{re.escape(name)} ?(\+= ?1|= ?{re.escape(name)} ?\+ ?1)"


def _itself(name: str) -> str:
    """Return the pattern of a name that is no part of another one, nor an attribute of something."""
    return rf"(?<![\w.]){re.escape(name)}(?![\w.])"


_EARLY_S: Final = 1.0  # a motion of more was counted in ticks, and has another fault
_FEW_TICKS: Final = 10
_RADIANS: Final = 6.3  # more is meant as degrees
_TOLERANCE: Final = 0.03  # of 15 degrees


def _radians_twice(seen: Searched) -> Mistake | None:
    """Find ``math.radians`` of an angle that is in radians already."""
    for line, found in _calls_of("radians", seen.script):
        if _in_radians(found[1], seen.script.lines[line - 1], seen.script):
            return mistake("radians_twice", line=line, written=found[0], inner=found[1].strip())
    return None


def _radians_of_pose(seen: Searched) -> Mistake | None:
    """Find ``math.radians`` of a pose's theta, or of ``math.atan2``."""
    for line, found in _calls_of("radians", seen.script):
        if _angle_of_pose(found[1], seen.script) or re.fullmatch(r"(?:math\.)?atan2\(.*\)", found[1].strip()):
            return mistake("radians_twice", line=line, written=found[0], inner=found[1].strip())
    return None


def _calls_of(function: str, script: ScriptText) -> Iterator[tuple[int, re.Match[str]]]:
    """Yield the line number and the match of each call of a conversion; the match's group is the argument."""
    for line in script.lines_with(rf"\b{function}\("):
        for found in re.finditer(rf"\b(?:math\.)?{function}\({_INNER}\)", script.lines[line - 1]):
            yield line, found


def _in_radians(written: str, line: str, script: ScriptText) -> bool:
    """Whether an expression is an angle in radians, or a rate; a few degrees may be meant as a tolerance."""
    value = value_of(written, script)
    if value is None:
        return re.search(r"\bpi\b", written) is not None and not re.search(r"180|degrees", written)
    parts = abs(value) / (math.pi / 12)
    of_circle = round(parts) >= 1 and abs(parts - round(parts)) < _TOLERANCE
    return 0.0 < abs(value) < _RADIANS and (of_circle or re.search(_RATE, line) is not None)


_RATE: Final = r"(?i)angular\.z ?=|\w*(speed|omega|rate|vel)\w* ?="


def _angle_of_pose(written: str, script: ScriptText) -> bool:
    """Whether an expression is a pose's theta, in a script that nowhere sets a theta in degrees."""
    converted = r"theta\w* *=.*(?:\b180|degrees\()"
    return re.fullmatch(r"[\w.]+\.theta", written.strip()) is not None and not script.lines_with(converted)


def _degrees_for_radians(seen: Searched) -> Mistake | None:
    """Find ``math.degrees`` of an angle that is in degrees already."""
    for line, found in _calls_of("degrees", seen.script):
        value = value_of(found[1], seen.script)
        if value is not None and abs(value) > 2 * _RADIANS:
            return mistake("degrees_for_radians", line=line, written=found[0], inner=found[1].strip())
    return None


def _degrees_of_radians(seen: Searched) -> Mistake | None:
    """Find an angle in degrees from which theta is subtracted, or that sets a turn rate nobody would choose."""
    script = seen.script
    is_too_fast = fastest_radps(seen.run) >= FAST_TURN_RADPS
    for line, found in _calls_of("degrees", script):
        before, after = found.string[: found.start()], found.string[found.end() :]
        beside = re.match(r" *- *([\w.]+)(?![\w.(]| *[*/])", after)
        mixed = beside is not None and _angle_of_pose(beside[1], script)
        if mixed or (is_too_fast and _becomes_rate(before, after, script)):
            return mistake("degrees_of_radians", line=line, written=found[0])
    return None


def _becomes_rate(before: str, after: str, script: ScriptText) -> bool:
    """Whether a line assigns what stands between these parts to a variable of which ``angular.z`` is computed."""
    assigned = re.fullmatch(r"\s*([\w.]+) *= *", before)
    if assigned is None or re.fullmatch(r"\s*(?:#.*)?", after) is None:
        return False
    name = re.escape(assigned[1])
    return bool(script.lines_with(rf"angular\.z *=[^#(]*(?<![\w.]){name}(?![\w.(])"))


# ---------------------------------------------------------------------------------------- clocks and times


_CLOCK: Final = r"(?:time\.(?:time|monotonic|perf_counter)\(\)|(?:[\w.]+\(\)\.)?now\(\)(?:\.nanoseconds)?)"


def _clock_before_sleep(seen: Searched) -> Mistake | None:
    """Find a start time that is taken before a pause, and not after it."""
    for line in seen.script.lines_with(rf"^[ \t]*[\w.]+ ?= ?[\w.()]*{_CLOCK}"):
        name = seen.script.lines[line - 1].partition("=")[0].strip()
        owner = seen.script.owner_of(line)
        for at in range(line + 1, min(line + 8, len(seen.script.lines) + 1)):
            text = seen.script.lines[at - 1].strip()
            if seen.script.owner_of(at) != owner or re.match(r"(while|def|for)\b", text):
                break
            slept = re.match(r"(?:time\.)?sleep\((.+)\)$", text)
            waited_s = value_of(slept[1], seen.script) if slept else None
            if waited_s is not None and waited_s >= _PAUSE_S and _loops_on(seen, name, at):
                values = {"name": name, "sleep": at, "waited": number(waited_s, "s")}
                return mistake("clock_before_sleep", line=line, **values)
    return None


_PAUSE_S: Final = 0.3


def _loops_on(seen: Searched, name: str, after: int) -> bool:
    """Whether one of the next lines is a ``while`` that looks at `name`."""
    nexts = seen.script.lines[after : after + 4]
    return any(re.match(rf"[ \t]*while\b.*(?<!\w){re.escape(name)}\b", line) for line in nexts)


def _start_once(seen: Searched) -> Mistake | None:
    """Find a start time that only ``__init__`` takes."""
    for line in seen.script.lines_with(rf"^[ \t]*self\.\w+ ?= ?.*{_CLOCK}"):
        name = seen.script.lines[line - 1].partition("=")[0].strip().removeprefix("self.")
        once = seen.script.assigned(name) is not None and seen.script.function_around(line) == "__init__"
        if once and len(seen.script.lines_with(rf"\bwhile\b.*\bself\.{name}\b")) > 1:
            again = seen.script.lines[line - 1].strip()
            return mistake("start_once", line=line, name=name, again=again)
    return None


def _since_1970(seen: Searched) -> Mistake | None:
    """Find what a clock shows compared with a few seconds, in a script that never takes the difference."""
    for line in seen.script.lines_with(r"^[ \t]*(self\.)?\w+ ?=(?!=)[^-]*$"):
        if not re.search(_SHOWN, seen.script.lines[line - 1]):
            continue
        name = seen.script.lines[line - 1].partition("=")[0].strip()
        itself = _itself(name)
        few = seen.script.lines_with(rf"\b(if|elif|while)\b.*{itself} ?<=? ?\d{{1,6}}(\.\d+)?(?![\w.])")
        if few and not seen.script.lines_with(rf"- ?{itself}|{itself} ?-"):
            return mistake("since_1970", line=line, name=name, compared=few[0])
    return None


_SHOWN: Final = r"(?:\btime\.time\(\)|\bnow\(\))"


def _deaf_loop(seen: Searched) -> Mistake | None:
    """Find a loop that waits for what a subscription's callback keeps, in which nothing spins."""
    heard = [name for _, name in seen.script.callbacks("subscription")]
    kept = {name for one in heard for name in seen.script.given_in(one)}
    others = [name for _, name in seen.script.callbacks("timer")] + heard
    if not kept or seen.script.lines_with(r"\bThread\(|Executor\("):
        return None
    for line in seen.script.lines_with(rf"\bwhile\b.*\bself\.({'|'.join(sorted(map(re.escape, kept)))})\b"):
        if not _spins(line, seen.script) and seen.script.function_around(line) not in others:
            name = re.findall(r"\bself\.(\w+)", seen.script.lines[line - 1])
            return mistake("deaf_loop", line=line, name=next(one for one in name if one in kept))
    return None


def _spins(line: int, script: ScriptText) -> bool:
    """Whether a block, or a function of the script that is called in it, spins."""
    block = "\n".join(script.block(line))
    called = (script.definition(name) for name in sorted(set(re.findall(r"(\w+)\(", block))))
    blocks = [block, *("\n".join(script.block(made.line)) for made in called if made is not None)]
    return any("spin" in text for text in blocks)


def _set_to_plus(seen: Searched) -> Mistake | None:
    """Find ``=+`` where ``+=`` is meant: the sign belongs to the number."""
    for line in seen.script.lines_with(r"^[ \t]*(self\.)?\w+ ?=\+ ?\d+$"):
        written = seen.script.lines[line - 1].strip()
        name, _, amount = written.partition("=+")
        right = f"{name.strip()} += {amount.strip()}"
        return mistake("set_to_plus", line=line, written=written, right=right, value=amount.strip())
    return None


def _waits_for_past(seen: Searched) -> Mistake | None:
    """Find a loop for as long as more time has passed than wanted, which it never has at the beginning."""
    passed = rf"\bwhile\b.*{_CLOCK}\)* ?- ?[\w.]+\)*(\.nanoseconds)?( ?/ ?1e9)? ?>=? ?[\w.]"
    for line in seen.script.lines_with(passed):
        if any("publish(" in text for text in seen.script.block(line)):
            return mistake("waits_for_past", line=line)
    return None


def _count_anew(seen: Searched) -> Mistake | None:
    """Find a count that the callback of a timer or subscription sets to 0 whenever it is called."""
    for kind in ("timer", "subscription"):
        for _, callback in seen.script.callbacks(kind):
            made = seen.script.definition(callback)
            body = seen.script.body(made.line) if made else []
            for line, text in body:
                zeroed = re.match(r"(\w+) ?= ?0(\.0)?$", text)
                if zeroed and _raised_once(zeroed[1], callback, seen.script):
                    return mistake("count_anew", line=line, name=zeroed[1], callback=callback)
    return None


def _raised_once(name: str, function: str, script: ScriptText) -> bool:
    """Whether one line of a function raises a name, once in each call, and the name is compared with 2 or more."""
    raised = script.lines_with(rf"^[ \t]*{_raising(name)}$")
    compared = script.lines_with(rf"(?<![\w.]){name} ?([<>]=?|==) ?([2-9]|\d\d+)\b")
    if len(raised) != 1 or not compared:
        return False
    return script.function_around(raised[0]) == function and not _is_repeated(raised[0], script)


def _is_repeated(line: int, script: ScriptText) -> bool:
    """Whether a line stands in a loop of its function."""
    return any(re.match(r"[ \t]*(for|while)\b", head) for head in script.conditions_of(line))


def _count_kept(seen: Searched) -> Mistake | None:
    """Find a count of a timer's ticks that tells a side from a turn, and that is never set back to 0."""
    sides = seen.findings.measures.get("sides")
    if sides is None or sides.value != 1.0:
        return None
    for _, callback in seen.script.callbacks("timer")[:1]:
        made = seen.script.definition(callback)
        text = "\n".join(seen.script.block(made.line)) if made else ""
        compared = set(re.findall(r"\b(?:el)?if ([\w.]+) ?<=? ?([\w.]+)", text))
        times = Counter(name for name, _ in compared)
        for name in [one for one in sorted(seen.script.counters) if times[one] == 2][:_MOST_COUNTS]:
            itself = _itself(name)
            back = seen.script.lines_with(rf"{itself} ?(=(?!=)(?! ?{re.escape(name)} ?\+)|%|-=)")
            if len(back) <= 1:
                return mistake("count_kept", name=name)
    return None


_MOST_COUNTS: Final = 8


def _wrong_time(seen: Searched) -> Mistake | None:
    """Find a turn that is given the time of the drive."""
    turned = _given(seen.script, r"(?i)turn|rotate|spin|zhuan", _DRIVE_TIME)
    driven = _given(seen.script, r"(?i)move|drive|straight|forward|go|zou", _TURN_TIME)
    assigned = (re.match(r"[ \t]*((?:self\.)?\w+) ?=(?!=)", text) for text in seen.script.lines)
    known = [found[1] for found in assigned if found is not None and re.search(_TURN_TIME, found[1])]
    if not turned or not known:
        return None
    values = {"line": turned[0][0], "given": turned[0][1], "wanted": known[0]}
    return (
        mistake("times_exchanged", **values, other=driven[0][0])
        if driven
        else mistake("wrong_time", **values)
    )


def _given(script: ScriptText, function: str, argument: str) -> list[tuple[int, str]]:
    """Return the calls of one argument whose names fit: line and argument."""
    calls = (re.match(r"[ \t]*(?:\w+\.)*(\w+)\( ?((?:self\.)?\w+) ?\)", text) for text in script.lines)
    return [
        (line, found[2])
        for line, found in enumerate(calls, start=1)
        if found is not None and re.search(function, found[1]) and re.search(argument, found[2])
    ]


_DRIVE_TIME: Final = r"(?i)(?:move|drive|straight|side|forward|line)\w*time"
_TURN_TIME: Final = r"(?i)(?:turn|rotate|spin)\w*time"


# ------------------------------------------------------------------------------------------------- loops


def _empty_function(seen: Searched) -> Mistake | None:
    """Find functions in which nothing but ``pass`` stands, and that the script calls."""
    empty = []
    heard = {one for kind in ("subscription", "service") for _, one in seen.script.callbacks(kind)}
    for line in seen.script.lines_with(r"^[ \t]*def \w+ ?\("):
        name = seen.script.lines[line - 1].split("def ")[1].partition("(")[0].strip()
        behind = seen.script.lines[line - 1].rpartition(":")[2].strip()
        body = [text for _, text in seen.script.body(line) if text != '""'] or [behind]
        if (
            body == ["pass"]
            and seen.script.calls(name)
            and name not in heard
            and not re.search(_HARMLESS, name)
        ):
            empty.append((line, name))
    if not empty:
        return None
    lines = ", ".join(str(line) for line, _ in empty[:4])
    return mistake("empty_function", lines=lines, names=", ".join(f"{name}()" for _, name in empty[:4]))


_HARMLESS: Final = r"(?i)log|print|wait|sleep|stop|clean|close|exit|shut|finish|done|handler|signal|__"
"""Names of functions that may be empty without harm to a motion."""


def _removes_in_loop(seen: Searched) -> Mistake | None:
    """Find a list that loses items while a loop goes through it."""
    for loop in seen.script.lines_with(r"^[ \t]*for \w+ in [\w.]+ ?:"):
        name = seen.script.lines[loop - 1].partition(" in ")[2].rpartition(":")[0].strip()
        for line, text in enumerate(seen.script.block(loop), start=loop):
            removes = rf"(?<![\w.]){re.escape(name)}\.(remove|pop)\(|\bdel {re.escape(name)}\["
            nexts = "".join(seen.script.lines[line : line + 1])
            if re.search(removes, text) and not re.match(r"[ \t]*(break|return)\b", nexts):
                return mistake("removes_in_loop", line=line, loop=loop, name=name)
    return None


def _leaves_loop(seen: Searched) -> Mistake | None:
    """Find a ``return`` or ``break`` that ends a ``for`` loop in its first round, whatever happens."""
    for loop in seen.script.lines_with(r"^[ \t]*for \w+ in "):
        for line, text in seen.script.body(loop):
            found = re.match(r"(return|break)\b", text)
            if found is not None:
                return mistake("leaves_loop", line=line, loop=loop, word=found[1])
    return None


def _timer_ends(seen: Searched) -> Mistake | None:
    """Find a ``threading.Timer`` that ends the program, and at the time at which the run ended."""
    ended_s = seen.run.outcome.duration_ns / 1e9
    for line in seen.script.lines_with(r"\bTimer\( ?[\w.]+ ?, ?[\w.]+"):
        found = re.search(r"\bTimer\( ?([\w.]+) ?, ?(?:\w+\.)*(\w+)", seen.script.lines[line - 1])
        after_s = value_of(found[1], seen.script) if found else None
        function = found[2] if found else ""
        made = seen.script.definition(function)
        inside = seen.script.block(made.line) if made else [function]
        ends = any(re.search(r"\b_?exit\b|\bshutdown\(|\bkill\(", text) for text in inside)
        if after_s is not None and ends and 0.0 <= ended_s - after_s < _MARGIN_S:
            return mistake("timer_ends", line=line, function=function, after=number(after_s, "s"))
    return None


_MARGIN_S: Final = 2.0


def _sleeps_on(seen: Searched) -> Mistake | None:
    """Find the long pause of a loop in which the run ended."""
    slept = sleep_at_horizon(seen.run)
    if slept is None or not 0 < slept.line <= len(seen.script.lines):
        return None
    written = re.search(r"\bsleep\((.+)\)$", seen.script.lines[slept.line - 1])
    pause_s = value_of(written[1], seen.script) if written else None
    if pause_s is None or pause_s < _LONG_PAUSE_S or not _is_repeated(slept.line, seen.script):
        return None
    return sleeps_too_long(seen.run, slept)


_LONG_PAUSE_S: Final = 5.0


def _no_loop(seen: Searched) -> Mistake | None:
    """Recognise a script that writes a part of the figure once, and has no loop to repeat it."""
    count, item = seen.findings.measures.get("sides"), seen.assignment.item_on("sides")
    wanted = item.low if item is not None else None
    if count is None or not wanted or not 0 < count.value < wanted or wanted % count.value:
        return None
    counted = seen.script.lines_with(r"\bcreate_timer\(|\bimport threading\b") + [
        line
        for line in seen.script.lines_with(r"^[ \t]*for\b")
        if not any(re.search(r"\.publish\(", text) for text in seen.script.block(line))
    ]
    waiting = seen.script.lines_with(rf"^[ \t]*while\b.*({_CLOCK}|\bok\(|time)")
    left = seen.script.lines_with(r"^[ \t]*(return$|raise\b|(\w+\.)*_?exit\(|quit\()")
    if counted or left or len(waiting) != len(seen.script.lines_with(r"^[ \t]*while\b")):
        return None
    values = {"count": f"{count.value:g}", "sides": f"{wanted:g}", "times": f"{wanted / count.value:g}"}
    return mistake("no_loop", **values)


def _grows(seen: Searched) -> Mistake | None:
    """Find a time, an angle or a speed that is multiplied by the counter of the loop."""
    for loop in seen.script.lines_with(r"^[ \t]*for \w+ in range\("):
        name = seen.script.lines[loop - 1].split("for ")[1].split()[0]
        if seen.script.callbacks("subscription"):
            return None  # with a pose the counter gives the heading or place of the next side
        grown = rf"\* ?(?:\( ?{name} ?[+-] ?\d ?\)|{name}\b)|(?<![\w.]){name} ?\*"
        for line, text in enumerate(seen.script.block(loop)[1:], start=loop + 1):
            found = re.search(grown, text)
            if (
                found is not None
                and "%" not in text
                and not re.search(r"(?i)\b(cos|sin)\(|\.info\(|\bprint\(|target|goal", text)
            ):
                return mistake("grows_in_loop", line=line, name=name, written=found[0].strip())
    return None


def _always_true(seen: Searched) -> Mistake | None:
    """Find a condition that ends in ``or`` and a bare number."""
    for line in seen.script.lines_with(r"[=!<>]=? ?[\w.]+ or \d+(\.\d+)?(?![\w.]| ?[=!<>%*/+-])"):
        found = re.search(r"([\w.% ]+) ?[=!]= ?([\w.]+) or (\d+)", seen.script.lines[line - 1])
        if found is not None and found[3].strip("0"):
            return mistake("always_true", line=line, second=found[3])
    return None


def unchanged_counter(run: Run, script: ScriptText) -> tuple[int, str] | None:
    """Return line and name of a counter that its ``while`` never changes, in a script that never ended."""
    if run.outcome.status is not RunStatus.INTERRUPTED:
        return None
    for line in script.lines_with(r"^[ \t]*while \(?[^\W\d]\w* ?(<=?|!=) ?[\w.]+\)? ?:"):
        found = re.match(r"[ \t]*while \(?(\w+) ?(?:<=?|(!=)) ?([\w.]+)", script.lines[line - 1])
        if found is None or re.search(_AMOUNT, found[1]):
            continue  # a time or a way grows by less than 1
        name, unlike, bound = found.groups()
        if unlike and not _starts_below(name, bound, script):
            continue  # it may have to count down
        if script.lines_with(rf"\b(global|nonlocal)\b.*\b{name}\b"):
            continue
        block = "\n".join(script.block(line)[1:])
        names = f"{name}|{re.escape(bound)}"
        changed = rf"(?<![\w.])({names})\b ?(,[^=\n]*|[-+*/%]|//)?=(?!=)|\b(for|as) [\w, ]*\b({names})\b|:="
        if not re.search(rf"{changed}|\b(break|return|raise|exit|shutdown|quit)\b", block):
            return line, name
    return None


def _starts_below(name: str, bound: str, script: ScriptText) -> bool:
    start, end = value_of(name, script), value_of(bound, script)
    return start is not None and end is not None and start < end


_AMOUNT: Final = r"(?i)time|elapsed|dur|sec|dist|angle|theta|yaw|turned|^[twxy]$"


def _counter_unchanged(seen: Searched) -> Mistake | None:
    found = unchanged_counter(seen.run, seen.script)
    return None if found is None else mistake("counter_unchanged", line=found[0], name=found[1])


# ------------------------------------------------------------------------------- what was given is not used


def _clamped(seen: Searched) -> Mistake | None:
    """Find a limit that makes the side of this run shorter than it was asked for."""
    given = _given_m(seen)
    bound = r"^[ \t]*(?:if|elif) ([\w.]+) ?(>=?|<=?) ?([\w.]+) ?:"
    for line in seen.script.lines_with(bound):
        found = re.match(bound, seen.script.lines[line - 1])
        limit = value_of(found[3], seen.script) if found else None
        body = seen.script.body(line)
        set_again = found and body and re.match(rf"{re.escape(found[1])} ?= ?[\w.]+$", body[0][1])
        if found and re.search(_NO_LENGTH, found[0]):
            continue
        beyond = (
            limit is not None
            and given is not None
            and (given > limit if found and found[2][0] == ">" else given < limit)
        )
        if set_again and beyond:
            return mistake("clamped", line=line, last=body[0][0], given=number(given or 0.0, "m"))
    for line in seen.script.lines_with(r"=.*\b(min|max)\("):
        found = re.search(r"\b(min|max)\( ?([\w.]+) ?, ?([\w.]+) ?\)", seen.script.lines[line - 1])
        if re.search(_NO_LENGTH, seen.script.lines[line - 1]):
            continue
        bounds = [value_of(part, seen.script) for part in found.groups()[1:]] if found else []
        known = next((value for value in bounds if value is not None), None)
        if (
            found
            and known is not None
            and given is not None
            and (given > known if found[1] == "min" else given < known)
        ):
            return mistake("clamped", line=line, last=line, given=number(given, "m"))
    return None


_NO_LENGTH: Final = r"(?i)speed|vel|linear|angular|rate|turn|angle|omega|theta|yaw|time|dur|\b[vwzt]\b"


def _given_m(seen: Searched) -> float | None:
    """Return the side that this run was given as input or argument."""
    case = next((one for one in seen.assignment.cases if one.id == seen.run.case), None)
    if case is None:
        return None
    found = re.findall(
        r"(?<![\w.])\d+(?:\.\d+)?(?!\w)", " ".join([*case.args, case.stdin or ""]).replace(":=", " ")
    )
    return float(found[-1]) if found else None


def _parameter_default(seen: Searched) -> Mistake | None:
    """Find a default that the run without a parameter shows to be another than the wanted one."""
    case = next((one for one in seen.assignment.cases if one.id == seen.run.case), None)
    wanted = seen.assignment.options.get("side_m")
    if case is None or case.args or case.stdin or not isinstance(wanted, (int, float)):
        return None
    for line in seen.script.lines_with(r"\bdeclare_parameter\("):
        found = re.search(r'\bdeclare_parameter\( ?"" ?, ?([\w.]+) ?\)', seen.script.lines[line - 1])
        given = value_of(found[1], seen.script) if found else None
        if (
            given is not None
            and given != wanted
            and re.search(_SIDE, seen.script.written(line))
            and len(seen.script.lines_with(r"\bdeclare_parameter\(")) == 1
        ):
            values = {"given": number(given, "m"), "wanted": number(float(wanted), "m")}
            return mistake("parameter_default", line=line, written=f"{float(wanted):.1f}", **values)
    return None


_SIDE: Final = r"(?i)declare_parameter\( *[\"'][^\"']*(side|len|bian|chang|size|边|长)"


# ------------------------------------------------------------------------------ callbacks and publishing


_MOTION: Final = r"\.(linear\.x|angular\.z) ?[-+]?=(?!=)(?! ?-?[0.]+ ?(;|\n|$))"


def _timer_stops(seen: Searched) -> Mistake | None:
    """Find the timer whose callback only stops, beside another one that drives."""
    timers = seen.script.callbacks("timer")
    stops, drives = [], []
    for line, name in timers:
        made = seen.script.definition(name)
        body = "\n".join(seen.script.block(made.line)[1:]) if made else ""
        if re.search(_MOTION, body):
            drives.append((line, name))
        elif re.search(r"\.publish\(", body):
            stops.append((line, name))
    if len(timers) < 2 or not stops or not drives:
        return None
    return mistake("timer_stops", line=stops[0][0], name=stops[0][1])


def _spin_once(seen: Searched) -> Mistake | None:
    """Find a ``spin_once`` that stands in no loop; where commands were lost, callbacks must have sent them."""
    callbacks = seen.script.lines_with(r"\bcreate_(timer|subscription|service)\(")
    if seen.mistake.code == "lost_at_home" and not callbacks:
        return None
    once = seen.script.lines_with(r"\bspin_once\(")
    loose = [line for line in once if _loop_around(seen.script, line) is None]
    spins = seen.script.lines_with(r"\bspin\(")
    return mistake("spin_once", line=loose[0]) if len(once) == len(loose) == 1 and not spins else None


def _loop_around(script: ScriptText, number: int) -> int | None:
    above = script.owner_of(number)
    while above is not None and not re.match(r"[ \t]*(while|for)\b", script.lines[above - 1]):
        above = script.owner_of(above)
    return above


_ENDS: Final = re.compile(r"\b(shutdown|destroy_timer|destroy_node|cancel|exit)\(|^raise SystemExit")


def _ends_in_callback(seen: Searched) -> Mistake | None:
    """Find a call in a timer's callback that ends the timer or the program at the first tick."""
    for _, name in seen.script.callbacks("timer"):
        made = seen.script.definition(name)
        body = seen.script.body(made.line) if made else ()
        always = itertools.takewhile(lambda one: not re.match(r"if\b|return\b|for\b|while\b", one[1]), body)
        ends = [line for line, text in always if _ENDS.search(text)]
        if ends:
            return mistake("ends_in_callback", lines=", ".join(map(str, ends)), name=name)
    return None


def _log_behind_spin(seen: Searched) -> Mistake | None:
    """Find a message that stands behind ``spin`` in the same function."""
    for spin in seen.script.lines_with(r"\bspin\("):
        around = seen.script.function_around(spin)
        for line in seen.script.lines_with(r"\bget_logger\(\)\.\w+\("):
            if line > spin and seen.script.function_around(line) == around:
                return mistake("log_behind_spin", line=line, spin=spin)
    return None


def _uncalled(seen: Searched) -> Mistake | None:
    return not_called(seen.run)


def _lookalike(seen: Searched) -> Mistake | None:
    """Recognise a topic in which a letter stands for a digit, or that a namespace has changed."""
    topic = seen.assignment.world.cmd_vel_topic
    used = [one.name for one in seen.run.outcome.endpoints if one.kind == "publisher"]
    for name in used:
        if name != topic and name.translate(_DIGITS) == topic.translate(_DIGITS):
            wrong = next(one for one, other in zip(name, topic, strict=True) if one != other)
            right = next(other for one, other in zip(name, topic, strict=True) if one != other)
            return mistake("lookalike", used=name, topic=topic, wrong=wrong, right=right)
        lines = seen.script.lines_with(r"\bnamespace ?=")
        if lines and name != topic and name.endswith(topic):
            return mistake("in_namespace", line=lines[0], used=name, topic=topic)
    return None


_DIGITS: Final = str.maketrans("lIOo", "1100")


def _no_publish(seen: Searched) -> Mistake | None:
    """Find a timer's callback in a script that publishes nothing anywhere."""
    timers = seen.script.callbacks("timer")
    if not timers or seen.script.lines_with(r"\bpublish\b"):
        return None
    made = seen.script.definition(timers[0][1])
    publisher = seen.script.publisher or "self.pub"
    return mistake("no_publish", name=timers[0][1], begins=made.line, publisher=publisher) if made else None


def _long_period(seen: Searched) -> Mistake | None:
    """Find a timer whose first tick comes after the end of the run."""
    for line in seen.script.lines_with(r"\bcreate_timer\("):
        found = re.search(r"create_timer\( ?([^,()]+),", seen.script.lines[line - 1])
        period_s = value_of(found[1].strip(), seen.script) if found else None
        if period_s is not None and period_s * 1e9 > seen.run.outcome.duration_ns:
            return mistake("long_period", line=line, period=number(period_s, "s"))
    return None


def _class_not_made(seen: Searched) -> Mistake | None:
    """Find a class that has the publisher, but of which the script creates no object."""
    for line in seen.script.lines_with(r"\bcreate_publisher\("):
        above: int | None = line
        while above is not None and not re.match(r"class (\w+)", seen.script.lines[above - 1]):
            above = seen.script.owner_of(above)
        found = re.match(r"class (\w+)", seen.script.lines[above - 1]) if above is not None else None
        if found is not None and not seen.script.lines_with(rf"(?<!class )\b{found[1]}\b"):
            return mistake("class_not_made", name=found[1], begins=above)
    return None


def _returns_before(seen: Searched) -> Mistake | None:
    """Find a ``return`` in the same block as the ``publish`` behind it."""
    for line in seen.script.lines_with(r"\.publish\("):
        owner = seen.script.owner_of(line)
        for at, text in seen.script.body(owner) if owner is not None else ():
            if at < line and re.match(r"return\b", text):
                return mistake("returns_before", line=at, publish=line)
    return None


def _waits_for_two(seen: Searched) -> Mistake | None:
    """Find a wait for more subscribers than there are."""
    lines = seen.script.lines_with(
        r"\bget_subscription_count\(\) ?(<= ?1|< ?[2-9]|!= ?[02-9])|\bcount_subscribers\([^)]*\) ?(<= ?1|< ?[2-9])"
    )
    lines += seen.script.lines_with(
        r"\bwhile not .*(get_subscription_count\(\)|count_subscribers\(.*\)) ?(> ?[1-9]|>= ?[2-9])"
    )
    return mistake("waits_for_two", line=lines[0]) if lines else None


def _hidden_int(seen: Searched) -> Mistake | None:
    """Find a whole number that was given to a float's field, if an ``except`` hides the error."""
    lines = seen.script.lines_with(r"\.(linear|angular)\.[xyz] ?= ?-?\d+$")
    if not lines or (hidden := seen.script.swallowed) is None:
        return None
    written = seen.script.lines[lines[0] - 1].strip()
    return mistake("hidden_int", line=lines[0], hidden=hidden, written=written, right=f"{written}.0")


_NO_MOTION: Final = frozenset(("only_stops", "no_turns", "zero_commands"))
_SHORT_TURN: Final = frozenset(("turn_too_short", "turned_one_radian", "half_turn", "turn_too_slow"))
_SHORT: Final = _SHORT_TURN | {"too_short", "turns_too_short", "one_radian"}
_COUNT: Final = frozenset(("sides_missing", "path_count", "path_unfinished"))
_LENGTHS: Final = frozenset(("wrong_lengths", "unequal_sides"))
_CORNERS: Final = frozenset(("turns_too_short", "turns_too_far", "one_corner_off", "one_radian"))
_LOST: Final = frozenset(
    (
        "place_away",
        "place_lost",
        "place_circled",
        "place_missed",
        "place_too_slow",
        "place_never_stops",
        "endless_turn_by_pose",
        "never_finished",
    )
)
_COUNTED: Final = _NO_MOTION | _COUNT | _LOST | {"endless_turn", "never_stops", "turned_instead", "wall_hit"}
"""What may come of a count or a state that never changes."""

_NOT_ON: Final = frozenset(("lost_at_home", "not_spinning", "never_spun"))

_CAUSES: Final[tuple[tuple[frozenset[str], Callable[[Searched], Mistake | None]], ...]] = (
    (_COUNTED, _set_to_plus),
    (_NO_MOTION | _LOST | {"never_stops", "wall_hit", "endless_turn"}, _deaf_loop),
    (_NO_MOTION | _SHORT, _floor_is_zero),
    (_NO_MOTION | _SHORT, _int_is_zero),
    (_NO_MOTION | _COUNT, _negative_time),
    (_NO_MOTION | _SHORT, _clock_before_sleep),
    (_NO_MOTION | _COUNT, _start_once),
    (_NO_MOTION, _since_1970),
    (_NO_MOTION, _waits_for_past),
    (_NO_MOTION | {"never_stops", "endless_turn"}, _count_anew),
    (frozenset(("sides_missing",)), _count_kept),
    (_NO_MOTION, _empty_function),
    (_SHORT | _CORNERS, _radians_twice),
    (_SHORT | _CORNERS | _LOST, _radians_of_pose),
    (
        frozenset(("endless_turn", "turns_too_far", "degrees_as_radians", "turned_instead")),
        _degrees_for_radians,
    ),
    (_CORNERS | _LOST | {"degrees_as_radians"}, _degrees_of_radians),
    (_CORNERS - {"one_radian"}, _wrong_time),
    (frozenset(("turns_too_short", "one_corner_off", "turn_too_short", "too_short")), _ticks_cut),
    (_SHORT, _counts_ticks),
    (_COUNT, _sleeps_on),
    (_COUNT, _removes_in_loop),
    (_COUNT, _leaves_loop),
    (_COUNT, _timer_ends),
    (_COUNT, _no_loop),
    (_LENGTHS | _CORNERS | _COUNT | {"other_figure"}, _always_true),
    (_LENGTHS | {"never_stops", "sides_extra", "drove_on", "turned_on"}, _counter_unchanged),
    (frozenset(("one_corner_off", "unequal_sides", "turns_too_far")), _grows),
    (frozenset(("wrong_lengths",)), _clamped),
    (frozenset(("wrong_lengths",)), _parameter_default),
    (frozenset(("stopped_at_once", "too_brief", "stop_in_loop")), _timer_stops),
    (_NOT_ON, _spin_once),
    (_NOT_ON, _ends_in_callback),
    (frozenset(("log_not_reached",)), _log_behind_spin),
    (frozenset(("log_not_reached", "no_final_stop", "never_stops", "drove_on", "turned_on")), _uncalled),
    (frozenset(("wrong_topic",)), _lookalike),
    (frozenset(("never_published",)), _no_publish),
    (frozenset(("never_published", "publish_not_reached")), _long_period),
    (frozenset(("publisher_not_reached",)), _class_not_made),
    (frozenset(("publish_not_reached",)), _returns_before),
    (frozenset(("waits_in_loop", "waits_without_spin")), _waits_for_two),
    (frozenset(("error_hidden",)), _hidden_int),
)
"""Which mistakes a cause explains, and what looks for it; the first that is found counts."""
