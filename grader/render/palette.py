"""Colours and line styles of the plots.

The hues are those of Okabe and Ito's palette ("Color Universal Design", 2008), told apart by readers of any
colour vision; each difference that matters also has its own line style or marker.
"""

INK = "#222222"
MUTED = "#6b6b6b"
FAINT = "#c9c9c9"
GRID = "#ececec"
PAPER = "#ffffff"

PASSED = "#0072B2"  # blue
FAILED = "#D55E00"  # vermillion
PASSED_TINT = "#dcebf5"
FAILED_TINT = "#fbe6d9"
START = "#009E73"  # bluish green
COMMAND = "#E69F00"  # orange
IDEAL = "#d6d6d6"
WALL = "#555555"

FAILED_DASHES = (0, (3.2, 1.4))


def verdict(ok: bool | None) -> str:
    """Return the colour of something within tolerance, out of it, or not judged."""
    if ok is None:
        return INK
    return PASSED if ok else FAILED
