"""Times that are measured, waited for or passed wrongly."""

import itertools
import math
import re
from typing import Final

from grader.checks.causes.searched import CLOCK, Searched, is_repeated, itself, sets
from grader.checks.measure import Mistake, mistake
from grader.checks.mistakes import motions_of, sleep_at_end, sleeps_too_long, with_ends
from grader.contracts.scoring import Run
from grader.messages.arithmetic import value_of
from grader.messages.quantity import number
from grader.messages.script import ScriptText

_PAUSE_S: Final = 0.3  # a shorter sleep before a motion changes nothing that is seen
_MOST_CLOCKS: Final = 50  # each is looked for in all lines
_TIME_OF_DAY: Final = r"(?:\btime\.time\(\)|\bnow\(\))"
_TO_SECONDS: Final = 0.99e9  # what divides nanoseconds by less does not make seconds of them
_FEW_SECONDS: Final = 60.0
_VALUE_OR_NAME: Final = r"[\w.]+(?: ?\* ?(?:\d{1,3}e\d+|1\d{3,12}))?"
_WHOLE_SECONDS: Final = (
    r"to_msg\(\)\.sec\b(?!.*\bnanosec\b)|seconds_nanoseconds\(\)\[0\]|"
    r"\bint\( ?time\.(?:time|monotonic|perf_counter)\(\)|"
    r"\.nanoseconds\)* ?// ?(?:int\( ?)?(?:1e9|10 ?\*\* ?9|1_?000_?000_?000)"
)
_FEW_NS: Final = 1e6  # a millisecond: what is compared with less is meant as seconds
_TO_NS: Final = r"(?i)\b1e9|10 ?\*\* ?9|1_?000_?000_?000|nanosec|\bns\b"
_NAME: Final = r"(?<![\w.])[\w.]{1,60}"
_DRIVE_TIME: Final = r"(?i)(?:move|drive|straight|side|forward|line)\w*time"
_TURN_TIME: Final = r"(?i)(?:turn|rotate|spin)\w*time"
_LONG_PAUSE_S: Final = 5.0
_HELD_S: Final = 0.1  # a command that acts for less is followed at once by the next one
_BESIDE_DEG: Final = 3.0  # so far the excess of a corner may be from what a held turn explains
_MARGIN_S: Final = 2.0  # between the end of a timer and that of the run
_NEAR_S: Final = 0.1  # a motion ends so much later than it should: a tick, or a turn of a loop


def clock_before_sleep(seen: Searched) -> Mistake | None:
    """Find a start time that is taken before a pause instead of after it."""
    for line, found in seen.script.matches(rf"^[ \t]*([\w.]+) ?= ?[\w.()]*{CLOCK}"):
        name = found[1]
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


def _loops_on(seen: Searched, name: str, after: int) -> bool:
    """Whether one of the next four lines is a ``while`` whose condition reads `name`, with no loop inside."""
    for at in range(after + 1, min(after + 5, len(seen.script.lines) + 1)):
        if re.match(rf"[ \t]*while\b.*(?<!\w){re.escape(name)}\b", seen.script.lines[at - 1]):
            inside = seen.script.block(at)[1:]  # a loop around others limits the time of all of them
            return not any(re.match(r"[ \t]*(for|while)\b", text) for text in inside)
    return False


def start_once(seen: Searched) -> Mistake | None:
    """Find a start time that only ``__init__`` or the module sets, though several motions are measured from it."""
    clocks = seen.script.matches(rf"^(?:[ \t]*(self\.)|)(\w+) ?= ?.*{CLOCK}")
    for line, found in itertools.islice(clocks, _MOST_CLOCKS):
        owner, name = found[1] or "", found[2]
        if seen.script.function_around(line) != ("__init__" if owner else ""):
            continue
        if owner and seen.script.assigned(name) is None:  # it is set elsewhere, too
            continue
        timed = _loops_timed_from(owner, name, seen.script)
        several = len(timed) > 1 or _counts_motions(owner + name, seen.script) if owner else bool(timed)
        if several:
            return mistake("start_once", line=line, name=owner + name, again=found.string.strip())
    return None


def _loops_timed_from(owner: str, name: str, script: ScriptText) -> list[int]:
    """Return the ``while`` loops that end some time after a start time, which is kept in ``self.`` or a global.

    Of a global, only those that run several times, in a function that does not set a variable of that name.
    """
    return [
        at
        for at in script.lines_with(rf"\bwhile\b.*{itself(owner + name)}")
        if not _has_another_condition(script.lines[at - 1])
        and (owner or (not _assigns(name, at, script) and _runs_again(at, script)))
    ]


def _counts_motions(start: str, script: ScriptText) -> bool:
    """Whether a timer's callback raises the only count where a time since `start` passes a fixed limit."""
    raised = script.lines_with(r"^[ \t]*self\.\w+ ?\+= ?1$")
    around = script.function_around(raised[0]) if len(raised) == 1 else ""
    if not around or around not in {one.name for one in script.callbacks("timer")}:
        return False
    passed = {found[1] for _, found in script.matches(rf"^[ \t]*([\w.]+) ?=(?!=).*- ?{itself(start)}")}
    compared = r"[ \t]*(?:if|elif) ([\w.]+) ?[<>]=? ?(?:Duration\( ?seconds ?= ?)?([\w.]+) ?\)? ?:$"
    heads = [re.match(compared, head) for head in script.conditions_around(raised[0])]
    limits = [found[2] for found in heads if found is not None and found[1] in passed]
    branch = "\n".join(script.block(script.owner_of(raised[0]) or 0))
    if len(limits) != 1 or re.search(r"\.(linear|angular)\.", branch):
        return False
    return not script.lines_with(rf"{itself(limits[0])} ?(\+=|=.*\+)")


def _assigns(name: str, at: int, script: ScriptText) -> bool:
    """Whether the function around a line assigns a name, or there is no function."""
    made = script.definition(script.function_around(at))
    return made is None or any(re.match(rf"[ \t]*{name} ?=(?!=)", text) for text in script.block(made.line))


def _has_another_condition(condition: str) -> bool:
    """Whether a condition asks for more than the time: then the time may be a limit of the whole run."""
    alone = re.sub(r"\brclpy\.ok\( ?\)( and\b)?|\band rclpy\.ok\( ?\)", "", condition)
    return len(re.findall(CLOCK, condition)) > 1 or re.search(r"\band\b", alone) is not None


def _runs_again(at: int, script: ScriptText) -> bool:
    """Whether the function around a line is called several times, or nowhere in sight."""
    calls = script.lines_with(rf"(?<!def )\b{re.escape(script.function_around(at))}\(")
    return len(calls) != 1 or is_repeated(calls[0], script)


def since_1970(seen: Searched) -> Mistake | None:
    """Find the time of day compared with a few seconds, in a script that never subtracts a start time from it."""
    for line, found in seen.script.matches(rf"^[ \t]*((?:self\.)?\w+) ?=(?!=)[^-]*?{_TIME_OF_DAY}[^-]*$"):
        name, name_alone = found[1], itself(found[1])
        compared = seen.script.lines_with(
            rf"\b(if|elif|while)\b.*{name_alone} ?<=? ?\d{{1,6}}(\.\d+)?(?![\w.])"
        )
        if compared and not seen.script.lines_with(rf"- ?{name_alone}|{name_alone} ?-"):
            return mistake("since_1970", line=line, name=name, compared=compared[0])
    return None


def waits_for_past(seen: Searched) -> Mistake | None:
    """Find a loop whose condition asks for *more* time than wanted to have passed: it ends before it begins."""
    passed = rf"\bwhile\b.*{CLOCK}\)* ?- ?[\w.]+\)*(\.nanoseconds)?( ?/ ?1e9)? ?>=? ?[\w.]"
    for line in seen.script.lines_with(passed):
        if any("publish(" in text for text in seen.script.block(line)):
            return mistake("waits_for_past", line=line)
    for _, found in seen.script.matches(rf"^[ \t]*([\w.]+) ?= ?{CLOCK} ?\+ ?[\w.]"):
        for line in seen.script.lines_with(rf"\bwhile\b.*{CLOCK} ?>=? ?{re.escape(found[1])}(?![\w.])"):
            return mistake("waits_for_past", line=line)
    for line, found in seen.script.matches(rf"^[ \t]*([\w.]+) ?= ?({CLOCK}) ?- ?[\w.]+$"):
        if seen.script.lines_with(rf"\bwhile\b.*{CLOCK} ?<=? ?{re.escape(found[1])}(?![\w.])"):
            written = found[0].strip()
            return mistake("ends_in_past", line=line, written=written, right=written.replace("-", "+"))
    return None


def nanoseconds_unit(seen: Searched) -> Mistake | None:
    """Find nanoseconds that are compared with seconds, or with seconds times something else than 1e9."""
    for line, found in seen.script.matches(
        rf"\.nanoseconds(?: ?- ?[\w.]+)?\)* ?[<>]=? ?({_VALUE_OR_NAME})\)* ?:"
    ):
        name, factor = found[1].partition("*")[0].strip(), found[1].partition("*")[2].strip()
        value = value_of(found[1], seen.script)
        right = f"{name} * 1e9"
        if factor and value_of(factor, seen.script) not in (1e9, None):
            return mistake("nanoseconds_unit", line=line, written=found[1], right=right)
        if not factor and not re.search(r"(?i)ns|nano", name) and _is_seconds(value, name, seen.script):
            return mistake("nanoseconds_unit", line=line, written=found[1], right=right)
    return None


def not_seconds(seen: Searched) -> Mistake | None:
    """Find nanoseconds, or what is left of them by a wrong divisor, that are compared with a few seconds later."""
    taken = r"^[ \t]*([\w.]+) ?= ?(.*\.nanoseconds\)*)(?: ?/ ?([\w.]+))?$"
    for line, found in seen.script.matches(taken):
        name, divisor = found[1], value_of(found[3], seen.script) if found[3] else 1.0
        if divisor is None or not 1.0 <= divisor < _TO_SECONDS:
            continue
        compared = seen.script.matches(
            rf"\b(?:if|elif|while)\b.*{itself(name)} ?[<>]=? ?([\w.]+)(?![\w.]| ?\*)"
        )
        limits = [value_of(one[1], seen.script) for _, one in compared]
        if any(limit is not None and 0.0 < limit < _FEW_SECONDS for limit in limits):
            return mistake("not_seconds", line=line, name=name, right=f"{name} = {found[2]} / 1e9")
    return None


def start_kept(seen: Searched) -> Mistake | None:
    """Find a branch that ends a motion at a time and keeps its start time, which another branch takes anew."""
    for timer in seen.script.callbacks("timer")[:1]:
        block = seen.script.block(timer.begins)
        keeping, renewals = [], dict[str, str]()  # branches without a new start time; new start times by name
        for line, text in enumerate(block, start=timer.begins):
            ends = re.match(r"[ \t]*(?:if|elif) [^:]*>=? ?[\w.]+( ?[/*] ?[\w.]+)? ?:$", text)
            inside = "\n".join(seen.script.block(line)[1:]) if ends is not None else ""
            taken = re.search(rf"^[ \t]*(self\.\w+) ?= ?[\w.()]*{CLOCK}.*$", inside, re.MULTILINE)
            if taken is not None:
                renewals[taken[1]] = taken[0].strip()
            elif re.search(r"^[ \t]*self\.\w+ ?=(?!=)", inside, re.MULTILINE):
                keeping.append((line, text))
        if len(renewals) != 1:
            continue
        ((name, renewal),) = renewals.items()
        wrong = [
            line
            for line, text in keeping
            if _compares_time_since(name, text, block) and not sets(name, line, seen.script)
        ]
        if len(wrong) == 1:
            return mistake("start_kept", line=wrong[0], name=name, again=renewal)
    return None


def _compares_time_since(start: str, condition: str, block: list[str]) -> bool:
    """Whether a condition compares the time since `start`, computed there or kept in a variable of the block."""
    names = re.findall(r"[\w.]+", condition.partition(">")[0])
    passed = rf"- ?{itself(start)}"
    return bool(re.search(passed, condition)) or any(
        re.match(rf"[ \t]*{re.escape(name)} ?=(?!=).*{passed}", text) for name in names for text in block
    )


def start_anew_each_tick(seen: Searched) -> Mistake | None:
    """Find a callback that takes the start time anew each time it is called, so that hardly any time passes."""
    for callback in seen.script.functions_called_back("timer", "subscription"):
        block = "\n".join(seen.script.block(callback.begins))
        for line, text in seen.script.body(callback.begins):
            taken = re.match(rf"(self\.\w+) ?= ?[\w.()]*{CLOCK}\S*$", text)
            if taken is None:
                continue
            since = re.search(rf"^[ \t]*(\w+) ?= ?.*{CLOCK}.*- ?{itself(taken[1])}", block, re.MULTILINE)
            if since and _is_compared(since[1], block):
                return mistake("start_anew_each_tick", line=line, name=taken[1], callback=callback.name)
    return None


def _is_compared(name: str, block: str) -> bool:
    """Whether a time is compared with a duration. A step of time is computed with, or compared with 0 at most."""
    time = itself(name)
    compared = rf"{time} ?[<>]=? ?(?!0?\.?0*(?![\w.]))|[\w.)\]] ?[<>]=? ?{time}"
    return bool(re.search(compared, block)) and not re.search(rf"[-+*/] ?=? ?{time}|{time} ?[*/]", block)


def _is_seconds(value: float | None, name: str, script: ScriptText) -> bool:
    """Whether a name holds seconds: its value is small, or no line could have made nanoseconds of it."""
    if value is not None:
        return 0.0 < value < _FEW_NS
    made = script.lines_with(rf"{itself(name)} ?=(?!=)|^(?!.*\b(?:def|while|if)\b).*\w\(.")
    return not any(re.search(_TO_NS, script.lines[at - 1]) for at in made)


def start_anew(seen: Searched) -> Mistake | None:
    """Find a loop that takes its own start, or end, anew in each round, so that the end never comes."""
    for loop in seen.script.lines_with(rf"^[ \t]*while\b.*({CLOCK}|<)"):
        for line, text in seen.script.body(loop):
            taken = re.match(rf"([\w.]+) ?= ?[\w.()]*{CLOCK}\S*( ?\+ ?[\w.]+)?$", text)
            if taken is None:
                continue
            compared = rf"\) ?<=? ?{itself(taken[1])}" if taken[2] else rf"- ?{itself(taken[1])}"
            if re.search(compared, seen.script.lines[loop - 1]):
                return mistake("start_anew", line=line, name=taken[1], loop=loop)
    return None


def reversed_time(seen: Searched) -> Mistake | None:
    """Find a loop that subtracts the present time from the start time: the result is below any limit."""
    for line, found in seen.script.matches(rf"\bwhile\b.*?({_NAME}) ?- ?({CLOCK})\)*(?:\.nanoseconds)? ?<"):
        taken = seen.script.lines_with(rf"^[ \t]*{re.escape(found[1])} ?= ?[\w.()]*{CLOCK}$")
        if taken:
            return mistake("reversed_time", line=line, right=f"{found[2]} - {found[1]}")
    return None


def publish_behind_loop(seen: Searched) -> Mistake | None:
    """Find a loop that only waits for the time of a motion, and behind it a publish that belongs into the loop."""
    for loop in seen.script.lines_with(rf"^[ \t]*while\b.*{CLOCK}"):
        body = seen.script.body(loop)
        only_waits = bool(body) and all(re.match(r"(time\.)?sleep\(|pass$", text) for _, text in body)
        behind = loop + len(seen.script.block(loop))
        text = seen.script.lines[behind - 1] if behind <= len(seen.script.lines) else ""
        if only_waits and re.match(r"[ \t]*[\w.]+\.publish\( ?\w+ ?\)$", text):
            return mistake("publish_behind_loop", line=behind, loop=loop)
    return None


def sleep_behind_loop(seen: Searched) -> Mistake | None:
    """Find a loop that publishes a motion again and again at one moment, and the pause that stands behind it."""
    for loop in seen.script.lines_with(r"^[ \t]*for\b.*\brange\("):
        block = seen.script.block(loop)
        behind = loop + len(block)
        slept = re.match(r"[ \t]*(?:time\.)?sleep\((.+)\)$", "".join(seen.script.lines[behind - 1 : behind]))
        if slept is None or seen.script.owner_of(behind) != seen.script.owner_of(loop):
            continue
        pause_s = value_of(slept[1], seen.script)
        if pause_s is None or pause_s > _PAUSE_S or not _lasted(pause_s, seen.run):
            continue  # the motion may be meant to last for that pause, or the loop sends stops
        body = "\n".join(block[1:])
        if re.search(r"\.publish\( ?(?!Twist\(|\w*stop)", body) and not re.search(r"sleep\(|spin", body):
            return mistake("sleep_behind_loop", line=behind, loop=loop)
    return None


def _lasted(pause_s: float, run: Run) -> bool:
    """Whether a motion lasted for just that pause."""
    return any(abs(lasted_ns / 1e9 - pause_s) <= _NEAR_S / 2.0 for _, lasted_ns in motions_of(run.trajectory))


def whole_seconds(seen: Searched) -> Mistake | None:
    """Find a time of which only the whole seconds are kept or compared, if motions last or end by such a time."""
    motions = motions_of(seen.run.trajectory)
    lasted = [lasted_ns / 1e9 for _, lasted_ns in motions]
    ends = [
        (first.t_ns + lasted_ns - motions[0][0].t_ns - motions[0][1]) / 1e9 for first, lasted_ns in motions
    ]
    if len(motions) < 2 or not any(
        all(abs(math.remainder(each, 1.0)) <= _NEAR_S for each in times) for times in (lasted, ends)
    ):
        return None
    used = rf"\b(?:while|if|elif)\b.*(?:{_WHOLE_SECONDS})|^[ \t]*([\w.]+) ?=(?!=).*(?:{_WHOLE_SECONDS})"
    for line, found in itertools.islice(seen.script.matches(used), _MOST_CLOCKS):
        name = itself(found[1] or "")
        since = rf"\b(?:while|if|elif)\b.*{name}|{name} ?-|- ?{name}"
        if found[1] is None or seen.script.lines_with(since):
            return mistake("whole_seconds", line=line)
    return None


def wrong_time(seen: Searched) -> Mistake | None:
    """Find a turn that is given the time of the drive; perhaps the drive is given that of the turn, too."""
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
    """Return the calls with one argument whose function and argument match: line and argument."""
    calls = (re.match(r"[ \t]*(?:\w+\.)*(\w+)\( ?((?:self\.)?\w+) ?\)", text) for text in script.lines)
    return [
        (line, found[2])
        for line, found in enumerate(calls, start=1)
        if found is not None and re.search(function, found[1]) and re.search(argument, found[2])
    ]


def sleeps_on(seen: Searched) -> Mistake | None:
    """Find the long pause in a loop during which the run ended."""
    slept = sleep_at_end(seen.run)
    if slept is None or not 0 < slept.line <= len(seen.script.lines):
        return None
    written = re.search(r"\bsleep\((.+)\)$", seen.script.lines[slept.line - 1])
    pause_s = value_of(written[1], seen.script) if written else None
    if pause_s is None or pause_s < _LONG_PAUSE_S or not is_repeated(slept.line, seen.script):
        return None
    return sleeps_too_long(seen.run, slept)


def no_stop_between(seen: Searched) -> Mistake | None:
    """Recognise turns that go on after their loop, because a pause follows it and no stop."""
    commands = seen.run.trajectory.commands
    lasting = [(one, (until - one.t_ns) / 1e9) for one, until in with_ends(seen.run.trajectory)]
    held = [
        (one, lasted_s)
        for (one, lasted_s), after in zip(lasting, [*commands[1:], None], strict=True)
        if one.w_radps and not one.v_mps and (after is None or after.v_mps) and lasted_s >= _HELD_S
    ]
    usual_s = sorted(lasted_s for _, lasted_s in lasting)[len(lasting) // 2] if lasting else 0.0
    if len(held) < 2 or seen.corner_deg is None:
        return None
    corner_deg, wanted_deg = seen.corner_deg
    extra_deg = [math.degrees(abs(one.w_radps)) * (lasted_s - usual_s) for one, lasted_s in held]
    if not any(abs(corner_deg - wanted_deg - extra) <= _BESIDE_DEG for extra in extra_deg):
        return None
    values = {"paused": number(held[0][1], "s"), "publisher": seen.script.publisher_name}
    return mistake("no_stop_between", excess=number(min(extra_deg), "deg"), **values)


def timer_ends(seen: Searched) -> Mistake | None:
    """Find a ``threading.Timer`` that ends the program at about the time at which the run ended."""
    ended_s = seen.run.outcome.duration_ns / 1e9
    for line, found in seen.script.matches(r"\bTimer\( ?([\w.]+) ?, ?(?:\w+\.)*(\w+)"):
        after_s, function = value_of(found[1], seen.script), found[2]
        made = seen.script.definition(function)
        inside = seen.script.block(made.line) if made else [function]
        ends = any(re.search(r"\b_?exit\b|\bshutdown\(|\bkill\(", text) for text in inside)
        if after_s is not None and ends and 0.0 <= ended_s - after_s < _MARGIN_S:
            return mistake("timer_ends", line=line, function=function, after=number(after_s, "s"))
    return None
