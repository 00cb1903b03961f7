"""Draw docs/images/credit.png: what each rubric item earns as one defect of the figure grows.

Run it after a change of rubrics or checks: ``python tools/draw_credit.py``.
"""

import math
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from grader.catalog import Catalog  # noqa: E402
from grader.checks import evaluate  # noqa: E402
from tests.unit.checks.trajectories import Leg, drive, polygon_legs, run_of  # noqa: E402

OUT = ROOT / "docs" / "images" / "credit.png"
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#7A7A7A")
DASHES = ("-", "--", "-.", ":")


@dataclass(frozen=True)
class Defect:
    """One panel: an assignment, what grows, and the legs for a size of it."""

    assignment: str
    title: str
    unit: str
    sizes: NDArray[np.float64]
    legs: Callable[[float], list[Leg]]


def one(values: Sequence[float], change: float) -> list[float]:
    """Return `values` with `change` added to the second."""
    return [value + change * (i == 1) for i, value in enumerate(values)]


def arcs(percent: float) -> list[Leg]:
    """A square whose corners are arcs with a radius in per cent of the side."""
    radius_m = max(2.0 * percent / 100.0, 1e-3)
    return [(2.0, 1.0, 0.0), (radius_m * math.pi / 2.0, 1.0, 1.0 / radius_m)] * 4


PERCENT = np.linspace(-30.0, 30.0, 121)
DEGREES = np.linspace(-25.0, 25.0, 101)
DEFECTS = (
    Defect("square", "one corner of a square", "°", DEGREES,
           lambda size: polygon_legs(4, corners_deg=one([90.0] * 4, size))),
    Defect("square", "every corner of a square", "°", DEGREES,
           lambda size: polygon_legs(4, corners_deg=[90.0 + size] * 4)),
    Defect("square", "one side of a square", "%", PERCENT,
           lambda size: polygon_legs(4, lengths_m=one([2.0] * 4, 2.0 * size / 100.0))),
    Defect("square", "corners of a square as arcs (radius / side)", "%", np.linspace(0.0, 60.0, 121), arcs),
    Defect("pentagon", "every corner of a pentagon", "°", DEGREES,
           lambda size: polygon_legs(5, corners_deg=[72.0 + size] * 5)),
    Defect("rectangle", "one side of the rectangle", "%", PERCENT,
           lambda size: polygon_legs(4, lengths_m=one([3.0, 2.0, 3.0, 2.0], 2.0 * size / 100.0))),
    Defect("straight", "heading change of a straight run", "°", np.linspace(0.0, 60.0, 121),
           lambda size: [(2.0, 1.0, math.radians(size) / 2.0)]),
    Defect("straight", "distance of a straight run", "m", np.linspace(0.0, 1.0, 101),
           lambda size: [(max(size, 1e-3), 1.0, 0.0)]),
    Defect("spin", "angle turned on the spot", "°", np.linspace(0.0, 420.0, 141),
           lambda size: [(max(math.radians(size), 1e-3), 0.0, 1.0)]),
)  # fmt: skip


def main() -> None:
    """Draw every panel."""
    figure = Figure(figsize=(15.0, 12.0), layout="constrained")
    catalog = Catalog()
    for axes, defect in zip(figure.subplots(3, 3).flat, DEFECTS, strict=True):
        task = catalog.get(defect.assignment)
        earned = np.array(
            [
                [item.earned for item in evaluate(task, [run_of(drive(defect.legs(float(size))))]).items]
                for size in defect.sizes
            ]
        )
        for i, item in enumerate(task.items):
            if np.ptp(earned[:, i]) > 0.0:
                style = {"color": COLOURS[i % len(COLOURS)], "ls": DASHES[i % len(DASHES)]}
                axes.plot(
                    defect.sizes, 100.0 * earned[:, i] / item.points, lw=2.0, label=item.title.en, **style
                )
        axes.fill_between(
            defect.sizes, 100.0 * earned.sum(axis=1) / task.max_score, color="#0072B2", alpha=0.12
        )
        axes.set_title(f"{task.id}: {defect.title}", fontsize=11)
        axes.set_xlabel(f"error ({defect.unit})" if min(defect.sizes) < 0.0 else f"size ({defect.unit})")
        axes.set_ylabel("credit (%)")
        axes.set_ylim(-3.0, 104.0)
        axes.grid(alpha=0.3)
        axes.legend(
            fontsize=8, loc="lower right" if defect.title.startswith(("angle", "distance")) else "best"
        )
    figure.suptitle(
        "Credit of each item (lines) and of the whole rubric (shaded) against the size of one defect"
    )
    OUT.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(OUT, dpi=80)
    print(OUT.relative_to(ROOT))


if __name__ == "__main__":
    main()
