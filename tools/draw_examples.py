"""Draw docs/images/<figure>.png: for each figure a right script and two wrong ones as a student sees them.

Grades the assignments' own scripts with everything real, so it takes some seconds: ``python
tools/draw_examples.py``.
"""

import io
import sys
from pathlib import Path

from matplotlib import image
from matplotlib.figure import Figure

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from grader.catalog import Catalog  # noqa: E402
from grader.contracts.grading import GradingJob  # noqa: E402
from grader.plots import draw  # noqa: E402
from grader.slot import Slot, SlotConfig  # noqa: E402

OUT = ROOT / "docs" / "images"
EXAMPLES = {
    "hello": ("solution", "wrong/warn_level", "wrong/silent"),
    "straight": ("solution", "wrong/curved", "wrong/there_and_back"),
    "backward": ("solution", "wrong/drove_forward", "wrong/too_short"),
    "spin": ("solution", "wrong/half_turn", "wrong/circling"),
    "square": ("solution", "wrong/arcs", "wrong/last_side_short"),
    "triangle": ("solution", "wrong/interior_angle", "wrong/last_corner_short"),
    "pentagon": ("solution", "wrong/turns_too_short", "wrong/still_a_square"),
    "rectangle": ("solution", "wrong/still_a_square", "wrong/last_side_short"),
    "hexagon": ("solution", "wrong/sides_grow", "wrong/one_side_missing"),
    "octagon": ("solution", "wrong/turns_too_short", "wrong/interior_angle"),
    "feedback_square": ("solution", "wrong/heading_only", "wrong/by_time"),
}
COLUMN_IN, DPI = 6.0, 90


def main() -> None:
    """Draw the figures named on the command line, or all."""
    catalog = Catalog()
    OUT.mkdir(parents=True, exist_ok=True)
    with Slot(SlotConfig()) as slot:
        for name in sys.argv[1:] or EXAMPLES:
            pictures = [_picture(catalog, slot, name, script) for script in EXAMPLES[name]]
            _side_by_side(pictures, EXAMPLES[name], OUT / f"{name}.png")
            print(f"docs/images/{name}.png")


def _picture(catalog: Catalog, slot: Slot, name: str, script: str) -> bytes:
    path = catalog.folder(name) / f"{script}.py"
    task = catalog.get(name)
    result = slot.grade(GradingJob(file_name=path.name, source=path.read_bytes(), assignment=task))
    return draw(task, result.report, result.trajectories[result.report.runs[0].case], "zh")


def _side_by_side(pictures: list[bytes], titles: tuple[str, ...], path: Path) -> None:
    arrays = [image.imread(io.BytesIO(picture)) for picture in pictures]
    height_in = COLUMN_IN * max(array.shape[0] / array.shape[1] for array in arrays) + 0.3
    figure = Figure(figsize=(COLUMN_IN * len(arrays), height_in), layout="constrained")
    for axes, array, title in zip(figure.subplots(1, len(arrays)), arrays, titles, strict=True):
        axes.imshow(array)
        axes.set_title(f"{title}.py", fontsize=10)
        axes.axis("off")
    figure.savefig(path, dpi=DPI)


if __name__ == "__main__":
    main()
