"""What `make` runs is there."""

import re
from importlib.util import find_spec
from pathlib import Path

import pytest

from tools.bootstrap import COMMANDS

ROOT = Path(__file__).resolve().parents[2]
STEPS = [(name, step) for name, steps in COMMANDS.items() for step in steps]


@pytest.mark.parametrize(("name", "step"), STEPS, ids=[" ".join((name, *step)) for name, step in STEPS])
def test_every_command_names_something_that_exists(name: str, step: list[str]) -> None:
    if step[0] == "-m":
        assert find_spec(step[1]) is not None
    else:
        assert (ROOT / step[0]).is_file()


def test_every_target_is_a_command_and_the_other_way_round() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert set(re.findall(r"\$\(RUN\) ([a-z-]+)", makefile)) == set(COMMANDS)
