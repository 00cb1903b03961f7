"""Importing the package must cost nothing; its names must be the real ones."""

import subprocess
import sys

import pytest

from grader import render
from tests.unit.render.samples import square_report


def test_importing_loads_neither_rich_nor_matplotlib() -> None:
    program = "import sys, grader.render; print({'rich', 'matplotlib', 'numpy'} & set(sys.modules))"
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "set()"


@pytest.mark.parametrize("name", sorted(render._HOME))
def test_each_name_is_found(name: str) -> None:
    assert getattr(render, name).__name__ == name


def test_other_names_are_not_there() -> None:
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        _ = render.nonsense  # type: ignore[attr-defined]


def test_json_is_the_canonical_form() -> None:
    graded = square_report()
    assert render.json_report(graded).encode() == graded.canonical_bytes()
