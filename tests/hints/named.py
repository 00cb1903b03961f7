"""Which causes the tests of checks name: the script that shows one of those may be slow."""

import re
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def words(*paths: Path) -> set[str]:
    """All words of these files."""
    return set(re.findall(r"\w+", "".join(path.read_text(encoding="utf-8") for path in paths)))


@cache
def named_by_checks() -> frozenset[str]:
    return frozenset(words(*(ROOT / "tests" / "unit" / "checks").glob("*.py")))
