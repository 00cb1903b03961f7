"""``python -m tests.hints``: grade all beginners' scripts with everything real and print what is not as expected.

With a part of a file's name (``python -m tests.hints _spin_``) only those; with ``-v`` all hints, to be read. With
``--obey`` changes are looked for and the first one is obeyed: what is told must gain (precision), and the share of
scripts for which something is told (coverage) is printed.
"""

import sys

from grader.grading.slot import Slot, SlotConfig
from tests.hints.beginners import Beginner, answer, beginners
from tests.hints.obeyed import tried


def main(*arguments: str) -> int:
    """Return 0 when every script gets the score and the cause that are expected."""
    wanted = [argument for argument in arguments if not argument.startswith("-")]
    chosen = [script for script in beginners() if all(part in script.file for part in wanted)]
    if "--obey" in arguments:
        return obey(chosen, tells_all="-v" in arguments)
    wrong = 0
    with Slot(SlotConfig()) as slot:
        for script in chosen:
            given = answer(slot, script)
            faults = given.faults(script)
            wrong += bool(faults)
            if faults or "-v" in arguments:
                print(
                    f"{script.file}: {'; '.join(faults) or 'as expected'}\n  {given.en}\n  {given.zh}",
                    flush=True,
                )
    print(f"{len(chosen)} scripts, {wrong} not as expected")
    return int(wrong > 0)


def obey(chosen: list[Beginner], *, tells_all: bool) -> int:
    """Print what obeying the first changes comes to; return 0 when every change that is told gains."""
    seen = told = gains = full = 0
    with Slot(SlotConfig()) as slot:
        for script in chosen:
            one = tried(slot, script)
            if one is None or script.verdict != "wrong":
                continue
            seen += 1
            told += one.after is not None
            gains += one.gains is True
            full += one.last == 100
            if one.gains is False or tells_all:
                codes = ", ".join(change.code for change in one.explanation.changes) or "nothing"
                print(f"{script.file}: {one.before:g} -> {one.after} -> {one.last:g}, {codes}", flush=True)
    print(
        f"{seen} scripts that lack marks: {told} with a change, {gains} gain when it is obeyed, {full} end at 100"
    )
    return int(gains < told)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
