"""`grader hints` prints every code with its sentence."""

import pytest

from grader.commands import cli


def test_codes_are_printed_with_their_sentences(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["hints", "--lang", "en"]) == 0
    lines = capsys.readouterr().out.splitlines()
    codes = [line.partition(":")[0] for line in lines]
    assert {"interior_angle", "wrong_topic", "degrees"} <= set(codes)
    assert all(line.partition(": ")[2] for line in lines)


def test_a_part_of_the_text_narrows_the_list(capsys: pytest.CaptureFixture[str]) -> None:
    cli.run(["hints", "turtle1", "--lang", "zh"])
    assert all("turtle1" in line for line in capsys.readouterr().out.splitlines())
