"""What the command line itself says."""

import argparse
from pathlib import Path

import pytest

from grader.commands import cli
from grader.commands import run as run_command


@pytest.mark.parametrize(
    ("arguments", "chinese", "english"),
    [
        (["chek"], "grader: command 不能是 'chek'，可选：", "invalid choice: 'chek'"),
        (["check"], "grader check: 缺少参数：file", "are required: file"),
        (["check", "a.py", "b.py"], "没有这样的参数：b.py", "unrecognized arguments: b.py"),
        (["check", "a.py", "--plot"], "--plot 后面缺少一个值", "expected one argument"),
        (["token", "revoke"], "要写其中一个：person --token", "is required"),
        (["serve", "--port", "x"], "--port 的值不对：'x'", "invalid int value"),
        (["run", "a.py", "--for", "x"], "", "is not a number of seconds"),
    ],
)
def test_wrong_arguments_are_told_in_both_languages(
    arguments: list[str], chinese: str, english: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as left:
        cli.run(arguments)
    assert left.value.code == cli.EXIT_NOT_DONE
    said = capsys.readouterr().err
    assert chinese in said
    assert english in said
    assert "--help" in said.splitlines()[-1]


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["a.py", "--for", "3", "--", "-p", "--", "x"], ["-p", "--", "x"]),
        (["--for", "3", "a.py", "--", "--ros-args", "--for", "9"], ["--ros-args", "--for", "9"]),
        (["a.py", "x", "--for", "3"], ["x"]),
        (["a.py", "--for", "3", "--"], []),
    ],
)
def test_what_follows_the_first_two_dashes_is_the_scripts(
    arguments: list[str], expected: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[argparse.Namespace] = []
    monkeypatch.setattr(run_command, "run", lambda arguments: seen.append(arguments) or 0)
    assert cli.run(["run", *arguments]) == 0
    assert (seen[0].file, seen[0].horizon_s, seen[0].args) == (Path("a.py"), 3.0, expected)
