"""``python -m tests.corpus``: grade the whole corpus with everything real and print the confusion matrix."""

import sys

from grader.grading.slot import Slot, SlotConfig
from tests.corpus.attempts import corpus
from tests.corpus.scoring import confusion, for_real


def main() -> int:
    """Return 0 when nothing was scored wrongly."""
    with Slot(SlotConfig()) as slot:
        score_for_real = for_real(slot)
        scored = []
        for attempt in corpus():
            scored.append(score_for_real(attempt))
            if scored[-1].scored_wrongly:
                print(scored[-1], flush=True)
            if len(scored) % 50 == 0:
                print(f"{len(scored)} graded", file=sys.stderr, flush=True)
    print(confusion(scored))
    return int(any(each.scored_wrongly for each in scored))


if __name__ == "__main__":
    sys.exit(main())
