"""Whoever writes an exercise finds every check: in the table of both guides, and in the file to begin from."""

import re
from pathlib import Path

import pytest

from grader.catalog import authoring
from grader.checks.kinds import KINDS

DOCS = Path(__file__).resolve().parents[3] / "docs"
SKELETON = Path(authoring.__file__).parent / "skeleton" / "assignment.yaml"


@pytest.mark.parametrize("name", ["exercises.md", "exercises.zh.md"])
def test_the_table_of_checks_has_them_all(name: str) -> None:
    lines = (DOCS / name).read_text(encoding="utf-8").splitlines()
    head = next(i for i, line in enumerate(lines) if re.fullmatch(r"\|[^|]+\| `check` \|[^|]+\|", line))
    rows = lines[head + 2 : lines.index("", head)]
    assert {kind for row in rows for kind in re.findall(r"`(\w+)`", row.split("|")[2])} == set(KINDS)


def test_a_new_assignment_names_all_checks() -> None:
    (comment,) = re.findall(
        r"^check: \w+ +# (.*(?:\n +# .*)*)", SKELETON.read_text(encoding="utf-8"), re.MULTILINE
    )
    assert set(KINDS) <= set(re.findall(r"\w+", comment))
