"""``python -m tests.hints``: grade and explain all beginners' scripts with everything real, and count hints.

With a part of a file's name (``python -m tests.hints _spin_``) only those; with ``-v`` all hints, to be read. The
first change is obeyed as a student would: what is told must gain. Where no change is proven, the cause, or the
report's hint where none is stated, must name one of the expected lines, or be of the expected kind.
"""

import sys
from collections import Counter

from grader.grading.slot import Slot, SlotConfig
from tests.hints.beginners import FOREIGN, Answer, Beginner, answer, beginners
from tests.hints.categories import is_right
from tests.hints.obeyed import Tried, tried

LEAST_PRECISION = 0.98
LEAST_COVERAGE = 0.84
"""Of the hints, those that are right; of the scripts that lack marks, those with a proven change."""


def main(*arguments: str) -> int:
    """Return 0 when scores are as expected, every change that is told gains, and both thresholds hold."""
    wanted = [argument for argument in arguments if not argument.startswith("-")]
    chosen = [script for script in beginners() if all(part in script.file for part in wanted)]
    counts: Counter[str] = Counter()
    with Slot(SlotConfig()) as slot:
        for script in chosen:
            given = answer(slot, script)
            one = tried(slot, script) if script.verdict == "wrong" else None
            kinds = _judged(script, given, one)
            counts.update(kinds)
            if {"fault", "worse", "misleading"} & set(kinds) or "-v" in arguments:
                print(f"{script.file}: {', '.join(kinds)}; {_told(given, one)}", flush=True)
    said, lacking = counts["right"] + counts["misleading"], counts["lacking"]
    precision = counts["right"] / said if said else 1.0
    coverage = counts["proven"] / lacking if lacking else 1.0
    print(f"{len(chosen)} scripts, {counts['fault']} not as expected; {lacking} lack marks:")
    print(f"{counts['proven']} with a proven change ({coverage:.0%}), {counts['full']} end at 100,")
    print(f"{counts['worse']} do not gain when obeyed; {counts['stated']} with a stated cause;")
    print(f"{said} hints, {precision:.1%} right")
    holds = precision >= LEAST_PRECISION and coverage >= LEAST_COVERAGE
    return int(not holds or counts["worse"] > 0 or counts["fault"] > 0)


def _judged(script: Beginner, given: Answer, one: Tried | None) -> list[str]:
    """Return what is to be counted of one script."""
    kinds = ["fault"] if given.faults(script) else []
    if one is None:
        return kinds
    kinds += ["lacking"] if script.category != FOREIGN else []
    if one.gains is not None:
        kinds += ["proven", "right" if one.gains else "worse"]
        return [*kinds, "full"] if one.last == one.most else kinds
    cause = one.explanation.cause
    kinds += ["stated"] if cause is not None else []
    code, sentence = (given.cause, given.en) if cause is None else (cause.code, cause.text.en)
    right = is_right(script.category, script.lines, code, sentence, crashed=given.crashed)
    return [*kinds, "right" if right else "misleading"]


def _told(given: Answer, one: Tried | None) -> str:
    if one is not None and one.explanation.changes:
        first = one.explanation.changes[0]
        return f"{first.text.en} ({one.before:g} -> {one.after:g} -> {one.last:g})"
    if one is not None and one.explanation.cause is not None:
        return f"{one.explanation.cause.text.en} | {given.en}"
    return given.en


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
