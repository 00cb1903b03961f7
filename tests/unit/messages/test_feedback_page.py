"""The page on feedback names every mistake, and no other."""

import re
from pathlib import Path

from tests.unit.messages.catalogs import catalog_texts

PAGE = Path(__file__).resolve().parents[3] / "docs" / "feedback.md"


def test_every_mistake_is_explained() -> None:
    rows = [line for line in PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("| `")]
    named = {code for row in rows for code in re.findall(r"`(\w+)`", row.split("|")[1])}
    known = {key.removeprefix("mistake.") for key in catalog_texts("zh") if key.startswith("mistake.")}
    assert named == known
