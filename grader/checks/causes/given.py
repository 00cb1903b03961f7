"""Inputs and parameters of the run that the script does not use as they were meant."""

import re
from typing import Final

from grader.checks.causes.searched import Searched
from grader.checks.measure import Mistake, mistake
from grader.messages.arithmetic import value_of
from grader.messages.quantity import number

_ABOUT_PCT: Final = 6.0
_NO_LENGTH: Final = (
    r"(?i)speed|vel|linear|angular|rate|turn|angle|omega|theta|yaw|time|dur"
    r"|forward|cmd|twist|power|gain|\b[vwzt]\b"
)
_SIDE: Final = r"(?i)declare_parameter\( *[\"'][^\"']*(side|len|bian|chang|size|边|长)"
_READ_IN: Final = r"\binput\(|\bget_parameter\(.*value\b"


def clamped(seen: Searched) -> Mistake | None:
    """Find a limit that makes the side of this run shorter than it was asked for."""
    given = _given_m(seen)
    if given is None:
        return None
    for line, found in seen.script.matches(r"^[ \t]*(?:if|elif) ([\w.]+) ?(>=?|<=?) ?([\w.]+) ?:"):
        if re.search(_NO_LENGTH, found[0]):
            continue
        body = seen.script.body(line)
        set_again = body and re.match(rf"{re.escape(found[1])} ?= ?[\w.]+$", body[0][1])
        limit = value_of(found[3], seen.script)
        if set_again and _is_beyond(given, limit, upper=found[2][0] == ">") and _drove(limit, given, seen):
            return mistake("clamped", line=line, last=body[0][0], given=number(given, "m"))
    for line, found in seen.script.matches(r"=.*\b(min|max)\( ?([\w.]+) ?, ?([\w.]+) ?\)"):
        if re.search(_NO_LENGTH, found.string):
            continue
        bounds = (value_of(part, seen.script) for part in found.groups()[1:])
        known = next((value for value in bounds if value is not None), None)
        if _is_beyond(given, known, upper=found[1] == "min") and _drove(known, given, seen):
            return mistake("clamped", line=line, last=line, given=number(given, "m"))
    return None


def _drove(limit_m: float | None, given_m: float, seen: Searched) -> bool:
    """Whether the worst side is off by what the limit makes of it, or is not known."""
    error = seen.findings.measures.get("side_error_pct")
    if error is None or limit_m is None:
        return True
    return abs(error.value - 100.0 * abs(limit_m - given_m) / given_m) <= _ABOUT_PCT


def _is_beyond(given: float, limit: float | None, *, upper: bool) -> bool:
    return limit is not None and (given > limit if upper else given < limit)


def _given_m(seen: Searched) -> float | None:
    """Return the side that this run was given as input or argument."""
    case = seen.case
    if case is None:
        return None
    found = re.findall(
        r"(?<![\w.])\d+(?:\.\d+)?(?!\w)", " ".join([*case.args, case.stdin or ""]).replace(":=", " ")
    )
    return float(found[-1]) if found else None


def parameter_default(seen: Searched) -> Mistake | None:
    """Find a default that the run without a parameter shows to be another than the wanted one."""
    case, wanted = seen.case, seen.assignment.options.get("side_m")
    if case is None or case.args or case.stdin or not isinstance(wanted, (int, float)):
        return None
    if len(seen.script.lines_with(r"\bdeclare_parameter\(")) != 1:
        return None
    for line, found in seen.script.matches(r'\bdeclare_parameter\( ?"" ?, ?([\w.]+) ?\)'):
        given = value_of(found[1], seen.script)
        if given is not None and given != wanted and re.search(_SIDE, seen.script.written(line)):
            values = {"given": number(given, "m"), "wanted": number(float(wanted), "m")}
            return mistake("parameter_default", line=line, written=f"{float(wanted):.1f}", **values)
    return None


def whole_only(seen: Searched) -> Mistake | None:
    """Find a test for digits, which no decimal passes, if a decimal was typed."""
    typed = "" if seen.case is None else (seen.case.stdin or "").strip()
    if not re.search(r"\d\.\d", typed):
        return None
    for line, found in seen.script.matches(r"\.(isdigit|isnumeric|isdecimal)\("):
        if "replace(" not in found.string:
            return mistake("whole_only", line=line, written=f"{found[1]}()", given=typed)
    return None


def int_refuses(seen: Searched) -> Mistake | None:
    """Find an ``int()`` of what was typed, a decimal, in a script that catches the error."""
    typed = "" if seen.case is None else (seen.case.stdin or "").strip()
    if not re.fullmatch(r"-?\d+\.\d+", typed) or not seen.script.lines_with(r"\bexcept\b"):
        return None
    for line, found in seen.script.matches(r"\bint\( ?(input\(|(\w+) ?\))"):
        kept = seen.script.assigned(found[2]) if found[2] else None
        if found[2] is None or (kept is not None and "input(" in kept.value):
            return mistake("int_of_decimal", line=line, given=repr(typed))
    return None


def rounded(seen: Searched) -> Mistake | None:
    """Find what makes a whole number of a side that was given with decimals."""
    given = _given_m(seen)
    if given is None or given == int(given):
        return None
    for line, found in seen.script.matches(r"\b(int|round)\((.*)"):
        whole = int(given) if found[1] == "int" else round(given)
        kept = re.match(r" ?(?:self\.)?(\w+) ?\)", found[2])
        known = seen.script.assigned(kept[1]) if kept is not None else None
        if known is not None and "side_error_pct" not in seen.findings.measures:
            continue  # it may be a number of something else
        read = re.search(_READ_IN, found[2] if known is None else known.value)
        if read is not None and whole != given and _drove(whole, given, seen):
            values = {"written": f"{found[1]}()", "given": number(given, "m"), "whole": number(whole, "m")}
            return mistake("rounded", line=line, **values)
    return None


def no_default(seen: Searched) -> Mistake | None:
    """Find a parameter that is declared without a default, in a run that sets none."""
    lines = seen.script.lines_with(r'\bdeclare_parameter\( ?"" ?\)')
    unset = seen.case is None or not seen.case.args
    return mistake("no_default", line=lines[0]) if lines and unset else None
