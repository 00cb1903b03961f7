"""Counts, and the loops and ticks that they count."""

import re
from collections import Counter
from typing import Final

from grader.checks.causes.searched import LOGS, SHOWS, Searched, is_repeated, itself
from grader.checks.measure import Mistake, mistake
from grader.checks.mistakes import motions_of
from grader.contracts.outcome import RunStatus
from grader.contracts.scoring import Run
from grader.messages.arithmetic import value_of
from grader.messages.quantity import number
from grader.messages.script import ScriptText


def counts_ticks(seen: Searched) -> Mistake | None:
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
        if found and count and _only_logs(line, found[1], seen.script):
            continue
        early = count is not None and (count * period_s <= _EARLY_S or count <= _FEW_TICKS)
        if found and count and count >= 1 and early and _lasted(count * period_s, period_s, seen):
            took = number(count * period_s, "s")
            period = number(period_s, "s", 4)
            values = {"name": found[1], "count": f"{count:g}", "period": period, "took": took}
            return mistake("counts_ticks", line=line, **values)
    return None


def _lasted(time_s: float, period_s: float, seen: Searched) -> bool:
    """Whether some motion, or turn where the corners are wrong, was commanded for about that time; or none was."""
    turns = "corner_deg" in seen.mistake.measures
    motions = [one for one in motions_of(seen.run.trajectory) if not turns or one[0].w_radps]
    off_s = [abs(lasted_ns / 1e9 - time_s) for _, lasted_ns in motions]
    return not off_s or min(off_s) <= _TICKS_OFF * period_s


def ticks_too_long(seen: Searched) -> Mistake | None:
    """Find a count of a timer's ticks that was reached after the run, or after the longest motion in it."""
    timers, run = seen.script.callbacks("timer"), seen.run
    made = seen.script.definition(timers[0][1]) if len(timers) == 1 else None
    if made is None:
        return None
    period = re.search(r"create_timer\( ?([^,()]+),", seen.script.lines[timers[0][0] - 1])
    period_s = value_of(period[1].strip(), seen.script) if period else None
    longest_s = max((lasted_ns for _, lasted_ns in motions_of(run.trajectory)), default=0) / 1e9
    for line, text in enumerate(seen.script.block(made.line), start=made.line):
        found = re.search(r"\b(?:if|elif) ([\w.]+) ?(?:<=?|>=?|==) ?([\w.]+) ?:", text)
        count = (
            value_of(found[2], seen.script) if found and _counted_each_tick(found[1], seen.script) else None
        )
        if found is None or count is None or not period_s or count * period_s < _LONG_S:
            continue
        took_s = count * period_s
        ends_s = run.outcome.duration_ns / 1e9
        if took_s > ends_s or abs(took_s - longest_s) <= _TICKS_OFF * period_s:
            values = {"count": f"{count:g}", "period": number(period_s, "s", 4), "took": number(took_s, "s")}
            return mistake("ticks_too_long", line=line, name=found[1], **values)
    return None


def sleeps_in_callback(seen: Searched) -> Mistake | None:
    """Find a pause in a timer's callback that counts its calls, so that each tick takes as long as the pause."""
    for _, name in seen.script.callbacks("timer"):
        made = seen.script.definition(name)
        body = seen.script.body(made.line) if made else []
        block = "\n".join(seen.script.block(made.line)) if made else ""
        begins = range(made.line, made.line + len(seen.script.block(made.line))) if made else range(0)
        loops = [line for line in seen.script.lines_with(r"^[ \t]*(while|for)\b") if line in begins]
        drives = any("publish(" in text for line in loops for text in seen.script.block(line))
        slept = [
            (line, found[1]) for line, text in body if (found := re.match(r"(?:time\.)?sleep\((.+)\)$", text))
        ]
        if len(slept) != 1 or len(re.findall(r"\bsleep\(", block)) != 1 or drives:
            continue
        pause_s = value_of(slept[0][1], seen.script)
        if pause_s is not None and pause_s >= _PAUSE_S:
            return mistake("sleeps_in_callback", line=slept[0][0], callback=name, pause=number(pause_s, "s"))
    return None


def count_not_reset(seen: Searched) -> Mistake | None:
    """Find a branch that ends at a count and leaves it as it is, though the next branch counts with it as well."""
    for _, callback in seen.script.callbacks("timer")[:1]:
        made = seen.script.definition(callback)
        ends: dict[str, list[tuple[int, list[str]]]] = {}
        for line, text in enumerate(
            seen.script.block(made.line) if made else [], start=made.line if made else 0
        ):
            found = re.match(r"[ \t]*if ([\w.]+) ?(?:>=?|==) ?[\w.]+ ?:$", text)
            if found and found[1] in seen.script.counters:
                ends.setdefault(found[1], []).append((line, seen.script.block(line)[1:]))
        for name, found_ends in ends.items():
            zeroed = [
                any(re.match(rf"[ \t]*{re.escape(name)} ?=", one) for one in body) for _, body in found_ends
            ]
            kept = [end for end, back in zip(found_ends, zeroed, strict=True) if not back]
            goes_on = [
                line for line, body in kept if any(re.match(r"[ \t]*self\.\w+ ?=(?!=)", one) for one in body)
            ]
            if any(zeroed) and len(goes_on) == 1 and _counted_each_tick(name, seen.script):
                return mistake("count_not_reset", line=goes_on[0], name=name)
    return None


_LONG_S: Final = 5.0
_PAUSE_S: Final = 0.2
_TICKS_OFF: Final = 3  # what a timer's first tick and the tick that changes the command may add
_EARLY_S: Final = 1.0  # a motion of more was counted in ticks, and has another fault

_FEW_TICKS: Final = 10


def _only_logs(line: int, name: str, script: ScriptText) -> bool:
    """Whether what a count leads to is only shown: nothing moves or stops because of it."""
    shown = rf"(?:.*{LOGS}|print\()|{re.escape(name)} ?= ?0$"
    body = script.body(line)
    return bool(body) and all(re.match(shown, text) for _, text in body)


def _counted_each_tick(name: str, script: ScriptText) -> bool:
    """Whether a name is raised by 1 at each tick: not only when another count has come somewhere, as sides are."""
    others = "|".join(re.escape(other) for other in script.counters - {name})
    for line in script.lines_with(rf"(?<![\w.]){_raising(name)}\s*$"):
        conditions = [script.lines[line - 1].rpartition(":")[0], *script.conditions_of(line)]
        if any(re.search(_MEASURED, head) for head in conditions):
            continue
        if any(re.search(r"[<>]", head) and not re.search(itself(name), head) for head in conditions):
            continue  # raised when something else passes a limit, such as the time of a side
        if not others or not re.search(rf"(?<![\w.])({others})\b", " ".join(conditions)):
            return True
    return False


_MEASURED: Final = r"(?i)abs\(|hypot|dist|err|diff|angle|theta|yaw|pose|target|goal|time|now|\d\.\d"
"""What a condition says that comes true once for each side, and not for a number of ticks."""


def _raising(name: str) -> str:
    """Return the pattern of what raises a name by 1."""
    return rf"{re.escape(name)} ?(\+= ?1|= ?{re.escape(name)} ?\+ ?1)"


def set_to_plus(seen: Searched) -> Mistake | None:
    """Find ``=+`` where ``+=`` is meant: the sign belongs to the number."""
    for line, found in seen.script.matches(r"^[ \t]*((?:self\.)?\w+) ?=\+ ?(\d+)$"):
        written, right = found[0].strip(), f"{found[1]} += {found[2]}"
        return mistake("set_to_plus", line=line, written=written, right=right, value=found[2])
    return None


def count_anew(seen: Searched) -> Mistake | None:
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
    return script.function_around(raised[0]) == function and not is_repeated(raised[0], script)


def count_kept(seen: Searched) -> Mistake | None:
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
            name_alone = itself(name)
            back = seen.script.lines_with(rf"{name_alone} ?(=(?!=)(?! ?{re.escape(name)} ?\+)|%|-=)")
            if len(back) <= 1:
                return mistake("count_kept", name=name)
    return None


_MOST_COUNTS: Final = 8


def grows(seen: Searched) -> Mistake | None:
    """Find a time, an angle or a speed that is multiplied by the counter of the loop."""
    if seen.script.callbacks("subscription"):
        return None  # with a pose the counter gives the heading or place of the next side
    for loop, head in seen.script.matches(r"^[ \t]*for (\w+) in range\("):
        name = head[1]
        grown = rf"\* ?(?:\( ?{name} ?[+-] ?\d ?\)|{name}\b)|(?<![\w.]){name} ?\*"
        for line, text in enumerate(seen.script.block(loop)[1:], start=loop + 1):
            found = re.search(grown, text)
            if (
                found is not None
                and "%" not in text
                and not re.search(r"(?i)\b(cos|sin)\(|\.info\(|\bprint\(|target|goal", text)
                and not _only_shown(text, seen.script)
            ):
                return mistake("grows_in_loop", line=line, name=name, written=found[0].strip())
    return None


def _only_shown(text: str, script: ScriptText) -> bool:
    """Whether a line assigns a name that only lines which log or print use."""
    assigned = re.match(r"[ \t]*(\w+) ?=(?!=)", text)
    if assigned is None:
        return False
    used = [script.written(at) for at, code in enumerate(script.lines, start=1) if code.strip()]
    used = [one for one in used if re.search(itself(assigned[1]), one) and one.strip() != text.strip()]
    used = [one for one in used if not re.match(rf"[ \t]*{assigned[1]} *=(?!=)", one)]
    return all(re.search(SHOWS, one) for one in used)


def always_true(seen: Searched) -> Mistake | None:
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
    for line, found in script.matches(r"^[ \t]*while \(?([^\W\d]\w*) ?(?:<=?|(!=)) ?([\w.]+)\)? ?:"):
        if re.search(_AMOUNT, found[1]):
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


def counter_unchanged(seen: Searched) -> Mistake | None:
    """Find a counter that the loop on it never changes."""
    found = unchanged_counter(seen.run, seen.script)
    return None if found is None else mistake("counter_unchanged", line=found[0], name=found[1])
