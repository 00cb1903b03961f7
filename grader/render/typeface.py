"""The plots' typeface: a Chinese subset shipped with the package, then matplotlib's own DejaVu Sans.

Fresh machines have no Chinese font, and installed ones differ, so that nothing of the system is used.
"""

import unicodedata
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import matplotlib
from matplotlib import font_manager
from matplotlib.ft2font import FT2Font

from grader.render.escape import visible_line

FAMILY = "Grader Sans SC"
FALLBACK = "DejaVu Sans"
_FILE = Path(__file__).parent / "fonts" / "GraderSansSC-Regular.otf"
_FALLBACK_FILE = Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf"
_MISSING = "□"


@cache
def rc() -> Mapping[str, object]:
    """Return the settings that select the typeface; makes it known to matplotlib once per process."""
    font_manager.fontManager.addfont(str(_FILE))
    return {"font.family": [FAMILY, FALLBACK], "axes.unicode_minus": True, "text.parse_math": False}


@cache
def _glyphs() -> frozenset[int]:
    return frozenset(FT2Font(str(_FILE)).get_charmap()) | frozenset(
        FT2Font(str(_FALLBACK_FILE)).get_charmap()
    )


def drawable(text: str, limit: int | None = None) -> str:
    """Return `text` on one line with glyphs for all of it.

    Emoji that no shipped font has are dropped with the space after them, other missing characters become
    ``□``, invisible ones are escaped.

    At most `limit` characters are returned; a longer text ends in ``…``.
    """
    plain = text.replace("\ufe0f", "")
    kept: list[str] = []
    skip_space = False
    for character in plain:
        if ord(character) > 0x2000 and _is_pictograph(character):
            skip_space = True
            continue
        if not (skip_space and character == " "):
            kept.append(character)
        skip_space = False
    shown = visible_line("".join(kept), limit)
    return "".join(character if ord(character) in _glyphs() else _MISSING for character in shown)


def _is_pictograph(character: str) -> bool:
    missing = ord(character) not in _glyphs()
    return missing and unicodedata.category(character) in {"So", "Sk"}


def columns(text: str) -> int:
    """Return the width of `text` in half-width columns (a Chinese character has two)."""
    return sum(2 if unicodedata.east_asian_width(character) in "WF" else 1 for character in text)


def clipped(text: str, most_columns: int) -> str:
    """Return `text` cut to `most_columns` half-width columns, with ``…`` when something was cut."""
    if columns(text) <= most_columns:
        return text
    width = 1
    for i, character in enumerate(text):
        width += columns(character)
        if width > most_columns:
            return text[:i].rstrip() + "…"
    return text
