"""The page on feedback names every mistake, and no other."""

import re
from pathlib import Path

from grader.messages import entries

PAGE = Path(__file__).resolve().parents[3] / "docs" / "feedback.md"


def test_every_mistake_is_explained() -> None:
    section = PAGE.read_text(encoding="utf-8").partition("\n## Mistakes\n")[2]  # other tables name scripts
    rows = [line for line in section.splitlines() if line.startswith("| `")]
    named = {code for row in rows for code in re.findall(r"`(\w+)`", row.split("|")[1])}
    known = {key.removeprefix("mistake.") for key in entries("zh", "grader") if key.startswith("mistake.")}
    assert named == known
