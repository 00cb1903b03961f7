"""``python -m tests.corpus.pairs [ASSIGNMENT...]``: what a script earns that was written for another assignment.

Every solution and every wrong script is graded for real under each assignment about a drive (or those named); what
earns more than 60 is printed. docs/feedback.md says why each of them does.
"""

import sys
from collections.abc import Iterator
from pathlib import PurePath

from grader.catalog import Catalog
from grader.contracts.grading import GradingJob
from grader.grading.slot import Slot, SlotConfig

UNDER = (
    "hello", "straight", "backward", "spin", "square", "triangle", "pentagon", "rectangle", "hexagon", "octagon",
    "right_triangle", "letter_l", "figure_eight", "two_circles", "go_to_goal", "patrol", "parking",
)  # fmt: skip
TOLD_FROM = 60.0


def scripts() -> Iterator[tuple[str, str, bytes]]:
    """Yield the assignment, the name and the text of every script that comes with one, but for the starters."""
    for one in Catalog().all():
        if one.input == "script":
            for name, source in Catalog().scripts(one.id).items():
                if name != "starter.py":
                    yield one.id, PurePath(name).name, source


def main(under: list[str]) -> None:
    """Print a line for each pair above the bound."""
    catalog = Catalog()
    with Slot(SlotConfig()) as slot:
        for home, file, source in scripts():
            for name in under or UNDER:
                job = GradingJob(file_name=file, source=source, assignment=catalog.get(name))
                report = slot.grade(job).report
                if (report.score or 0.0) > TOLD_FROM:
                    lost = ", ".join(
                        f"{one.id} {one.earned:g}/{one.points:g}"
                        for one in report.items
                        if one.earned < one.points
                    )
                    print(f"{home}/{PurePath(file).stem}\t{name}\t{report.score:g}\t{lost}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
