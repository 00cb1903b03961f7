"""``python -m tests.corpus``: grade the whole corpus with everything real and print the confusion matrix."""

import sys

from grader.grading.slot import Slot, SlotConfig
from tests.corpus.attempts import corpus
from tests.corpus.judging import confusion, for_real


def main() -> int:
    """Return 0 when nothing was misjudged."""
    with Slot(SlotConfig()) as slot:
        judge = for_real(slot)
        judged = []
        for attempt in corpus():
            judged.append(judge(attempt))
            if judged[-1].misjudged:
                print(judged[-1], flush=True)
            if len(judged) % 50 == 0:
                print(f"{len(judged)} graded", file=sys.stderr, flush=True)
    print(confusion(judged))
    return int(any(each.misjudged for each in judged))


if __name__ == "__main__":
    sys.exit(main())
