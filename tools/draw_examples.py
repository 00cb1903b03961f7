"""Draw docs/images/<figure>.png: for each figure a right script above two wrong ones, as a student sees them.

Grades the assignments' own scripts with everything real, so it takes some seconds: ``python
tools/draw_examples.py``.
"""

import io
import sys
from pathlib import Path

from matplotlib import image
from matplotlib.figure import Figure
from PIL import Image

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from grader.catalog import Catalog  # noqa: E402
from grader.contracts.grading import GradingJob  # noqa: E402
from grader.grading.slot import Slot, SlotConfig  # noqa: E402
from grader.use_cases.pictures import draw  # noqa: E402

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
WIDTH_IN, CAPTION_IN, DPI = 12.0, 0.4, 90
"""Large enough to be read in a page of 1,000 pixels."""

COLOURS = 256
"""The pictures need no more, and take half the space."""


def main() -> None:
    """Draw the figures named on the command line, or all."""
    catalog = Catalog()
    OUT.mkdir(parents=True, exist_ok=True)
    with Slot(SlotConfig()) as slot:
        for name in sys.argv[1:] or EXAMPLES:
            pictures = [_picture(catalog, slot, name, script) for script in EXAMPLES[name]]
            _stacked(pictures, EXAMPLES[name], OUT / f"{name}.png")
            print(f"docs/images/{name}.png")


def _picture(catalog: Catalog, slot: Slot, name: str, script: str) -> bytes:
    task, source = catalog.get(name), catalog.scripts(name)[f"{script}.py"]
    result = slot.grade(GradingJob(file_name=f"{Path(script).name}.py", source=source, assignment=task))
    return draw(task, result.report, result.trajectories[result.report.runs[0].case], "zh")


def _stacked(pictures: list[bytes], titles: tuple[str, ...], path: Path) -> None:
    arrays = [image.imread(io.BytesIO(picture)) for picture in pictures]
    heights_in = [WIDTH_IN * array.shape[0] / array.shape[1] for array in arrays]
    whole_in = sum(heights_in) + CAPTION_IN * len(arrays)
    figure = Figure(figsize=(WIDTH_IN, whole_in))
    top_in = whole_in
    for array, title, height_in in zip(arrays, titles, heights_in, strict=True):
        top_in -= CAPTION_IN
        figure.text(0.5, (top_in + 0.12) / whole_in, f"{title}.py", ha="center", family="monospace")
        top_in -= height_in
        axes = figure.add_axes((0.0, top_in / whole_in, 1.0, height_in / whole_in))
        axes.imshow(array, aspect="auto")
        axes.axis("off")
    drawn = io.BytesIO()
    figure.savefig(drawn, dpi=DPI)
    Image.open(drawn).convert("RGB").quantize(
        COLOURS, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE
    ).save(path, optimize=True)


if __name__ == "__main__":
    main()
