"""``python -m tests.hints``: grade all beginners' scripts with everything real and print what is not as expected.

With a part of a file's name (``python -m tests.hints _spin_``) only those; with ``-v`` all hints, to be read.
"""

import sys

from grader.grading.slot import Slot, SlotConfig
from tests.hints.beginners import answer, beginners


def main(*arguments: str) -> int:
    """Return 0 when every script gets the score and the cause that are expected."""
    wanted = [argument for argument in arguments if argument != "-v"]
    chosen = [script for script in beginners() if all(part in script.file for part in wanted)]
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


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
