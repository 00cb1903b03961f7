"""``python -m benchmarks.explanations [EVERY]``: how long explanations take, of every nth kept wrong script.

One warm grading process on an otherwise idle machine: what passes between the marks and their explanation.
"""

import statistics
import sys
import time

from grader.contracts.errors import RefusedError
from grader.contracts.explanation import is_worth_trying
from grader.contracts.grading import GradingJob
from grader.contracts.upload import check_source
from grader.grading.slot import Slot, SlotConfig
from tests.e2e.grading_slot import catalog
from tests.hints.beginners import beginners


def main(every: int = 1) -> None:
    """Print the distribution of times, and the slowest scripts."""
    taken: list[tuple[float, int, str]] = []
    with Slot(SlotConfig()) as slot:
        for script in [one for one in beginners() if one.verdict == "wrong"][::every]:
            job = GradingJob(
                file_name=script.file, source=script.source, assignment=catalog().get(script.assignment)
            )
            try:
                check_source(script.source)
            except RefusedError:
                continue
            if not is_worth_trying(job.assignment, slot.grade(job).report):
                continue
            begun_s = time.perf_counter()
            tried = slot.explain(job).tried
            taken.append((time.perf_counter() - begun_s, tried, script.file))
    times = sorted(taken)
    shares = {
        share: times[min(int(share * len(times)), len(times) - 1)][0]
        for share in (0.25, 0.5, 0.75, 0.9, 0.95)
    }
    print(f"{len(times)} explanations, mean {statistics.fmean(one for one, _, _ in times):.2f} s")
    print(", ".join(f"{share:.0%} within {value:.2f} s" for share, value in shares.items()))
    for took_s, tried, file in times[-10:]:
        print(f"{took_s:6.2f} s, {tried:2} tried, {file}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
