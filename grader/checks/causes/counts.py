"""Counts, and the loops and ticks that they count."""

import re
from collections import Counter
from typing import Final

from grader.checks.causes.searched import SHOWS, Searched, is_repeated, itself
from grader.checks.measure import Mistake, mistake
from grader.contracts.outcome import RunStatus
from grader.contracts.scoring import Run
from grader.messages.arithmetic import value_of
from grader.messages.script import ScriptText

_MEASURED: Final = r"(?i)abs\(|hypot|dist|err|diff|angle|theta|yaw|pose|target|goal|time|now|\d\.\d"
"""What a condition says that comes true once for each side, and not for a number of ticks."""
_MOST_COUNTS: Final = 8
_AMOUNT: Final = r"(?i)time|elapsed|dur|sec|dist|angle|theta|yaw|turned|^[twxy]$"


def counted_each_tick(name: str, script: ScriptText) -> bool:
    """Whether a name is raised by 1 at each tick: not only when another count has come somewhere, as sides are."""
    others = "|".join(re.escape(other) for other in script.counters - {name})
    for line in script.lines_with(rf"(?<![\w.]){_raising(name)}\s*$"):
        conditions = [script.lines[line - 1].rpartition(":")[0], *script.conditions_around(line)]
        if any(re.search(_MEASURED, head) for head in conditions):
            continue
        if any(re.search(r"[<>]", head) and not re.search(itself(name), head) for head in conditions):
            continue  # raised when something else passes a limit, such as the time of a side
        if not others or not re.search(rf"(?<![\w.])({others})\b", " ".join(conditions)):
            return True
    return False


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
    for callback in seen.script.callbacks("timer", "subscription"):
        for line, text in seen.script.body(callback.begins):
            zeroed = re.match(r"(\w+) ?= ?0(\.0)?$", text)
            if zeroed and _raised_once(zeroed[1], callback.name, seen.script):
                return mistake("count_anew", line=line, name=zeroed[1], callback=callback.name)
    return None


def _raised_once(name: str, function: str, script: ScriptText) -> bool:
    """Whether one line of a function raises a name, once in each call, and the name is compared with 2 or more."""
    raised = script.lines_with(rf"^[ \t]*{_raising(name)}$")
    compared = script.lines_with(rf"(?<![\w.]){name} ?([<>]=?|==) ?([2-9]|\d\d+)\b")
    if len(raised) != 1 or not compared:
        return False
    return script.function_around(raised[0]) == function and not is_repeated(raised[0], script)


def count_kept(seen: Searched) -> Mistake | None:
    """Find a count that ends a motion and is never set back to 0: of a loop in a loop, or of a timer's ticks."""
    sides = seen.findings.measures.get("sides")
    if sides is None or sides.value != 1.0:
        return None
    for line, found in list(seen.script.matches(r"^[ \t]+while ([^\W\d]\w*) ?<=? ?[\w.]+ ?:"))[:_MOST_COUNTS]:
        given = seen.script.lines_with(rf"{itself(found[1])} ?=(?!=)(?! ?{found[1]} ?\+)")
        heads = [head for head in seen.script.heads_around(line) if re.match(r"[ \t]*(for|while)\b", head[1])]
        if heads and found[1] in seen.script.counters and given and max(given) < heads[-1][0]:
            return mistake("count_kept", name=found[1])
    for timer in seen.script.callbacks("timer")[:1]:
        text = "\n".join(seen.script.block(timer.begins))
        compared = set(re.findall(r"\b(?:el)?if ([\w.]+) ?<=? ?([\w.]+)", text))
        times = Counter(name for name, _ in compared)
        for name in [one for one in sorted(seen.script.counters) if times[one] == 2][:_MOST_COUNTS]:
            name_alone = itself(name)
            back = seen.script.lines_with(rf"{name_alone} ?(=(?!=)(?! ?{re.escape(name)} ?\+)|%|-=)")
            if len(back) <= 1:
                return mistake("count_kept", name=name)
    return None


def grows(seen: Searched) -> Mistake | None:
    """Find a time, an angle or a speed that is multiplied by the counter of the loop."""
    if seen.script.callbacks("subscription"):
        return None  # with a pose the counter gives the heading or place of the next side
    for loop, head in seen.script.matches(r"^[ \t]*for (\w+) in range\("):
        name = head[1]
        grown = rf"(?<!\*)\* ?(?!\*)(?:\( ?{name} ?[+-] ?\d ?\)|{name}\b)|(?<![\w.]){name} ?\*"
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
    bounds = r"[\w.]+(?: ?[*/+-] ?[\w.]+)*"
    for line, found in script.matches(rf"^[ \t]*while \(?([^\W\d]\w*) ?(?:<=?|(!=)) ?({bounds})\)? ?:"):
        if re.search(_AMOUNT, found[1]):
            continue  # a time or a way grows by less than 1
        name, unlike, bound = found.groups()
        if unlike and not _starts_below(name, bound, script):
            continue  # it may have to count down
        if script.lines_with(rf"\b(global|nonlocal)\b.*\b{name}\b"):
            continue
        block = "\n".join(script.block(line)[1:])
        names = "|".join([name, *map(re.escape, re.findall(r"[A-Za-z_][\w.]*", bound))])
        changed = rf"(?<![\w.])({names})\b ?(,[^=\n]*|[-+*/%]|//)?=(?!=)|\b(for|as) [\w, ]*\b({names})\b|:="
        if not re.search(rf"{changed}|\b(break|return|raise|exit|shutdown|quit)\b", block):
            return line, name
    return None


def _starts_below(name: str, bound: str, script: ScriptText) -> bool:
    start, end = value_of(name, script), value_of(bound, script)
    return start is not None and end is not None and start < end


def counter_unchanged(seen: Searched) -> Mistake | None:
    """Find a counter that the loop on it never changes."""
    found = unchanged_counter(seen.run, seen.script)
    return None if found is None else mistake("counter_unchanged", line=found[0], name=found[1])
