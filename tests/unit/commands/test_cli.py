"""What the command line itself says."""

import argparse
import io
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from grader.commands import cli
from grader.commands import run as run_command


def test_a_setting_names_the_language_of_commands(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("GRADER_DEFAULT_LANGUAGE", "en")
    assert cli.run(["assignments", "show", "square"]) == 0
    assert "正方形" not in capsys.readouterr().out
    assert cli.run(["assignments", "show", "square", "--lang", "zh"]) == 0
    assert "正方形" in capsys.readouterr().out
    monkeypatch.setenv("GRADER_DEFAULT_LANGUAGE", "fr")
    assert cli.run(["check", "square.py"]) == cli.EXIT_NOT_DONE
    assert capsys.readouterr().err == "grader: GRADER_DEFAULT_LANGUAGE 只能是 zh 或 en，不能是 'fr'\n"


@pytest.mark.parametrize(
    ("arguments", "chinese", "english"),
    [
        (["chek"], "grader: command 不能是 'chek'，可选：", "invalid choice: 'chek'"),
        (["check"], "grader check: 缺少参数：file", "are required: file"),
        (["check", "a.py", "b.py"], "没有这样的参数：b.py", "unrecognized arguments: b.py"),
        (["check", "a.py", "--plot"], "--plot 后面缺少一个值", "expected one argument"),
        (["check", "a.py", "--isolation", "stict"], "（是不是 strict？）", "(did you mean strict?)"),
        (["check", "a.py", "--json=1"], "--json 后面不写值，多了 '1'", "ignored explicit argument"),
        (["check", "a.py", "--a", "x"], "--a 写得不完整", "ambiguous option"),
        (["token", "revoke"], "要写其中一个：person --token", "is required"),
        (["token", "issue", "li", "--days", "0"], "天数从 1 到", "1 to 3660 days"),
        (["serve", "--port", "x"], "--port：'x' 不行：要写整数", "write a whole number"),
        (["run", "a.py", "--for", "x"], "--for：'x' 不行：要写虚拟秒数", "write virtual seconds"),
        (["run", "a.py", "--speed", "0"], "--speed：'0' 不行：要写倍数", "write a factor"),
        (["run", "a.py", "--topic", "a b"], "不是话题名", "no name of a topic"),
    ],
)
@pytest.mark.parametrize("language", ["zh", "en"])
def test_a_wrong_argument_is_one_message_in_one_language(
    arguments: list[str], chinese: str, english: str, language: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as left:
        cli.run([*arguments, f"--lang={language}"] if language == "en" else arguments)
    assert left.value.code == cli.EXIT_NOT_DONE
    said, help_line = capsys.readouterr().err.splitlines()
    wanted, other = (chinese, english) if language == "zh" else (english, chinese)
    assert wanted in said
    assert other not in said
    assert help_line.endswith("--help")


def test_output_that_cannot_be_written_is_one_message() -> None:
    command = [sys.executable, "-m", "grader", "assignments", "list", "--lang", "en"]
    with open("/dev/full", "w") as full:
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert (done.returncode, done.stderr.startswith("grader: the output cannot be written: ")) == (2, True)
    closed = subprocess.run(
        ["/bin/sh", "-c", f"{shlex.join(command)} >&-"], stderr=subprocess.PIPE, text=True, check=False
    )
    assert (closed.returncode, closed.stderr) == (0, "")


def test_every_error_of_argparse_has_its_chinese_words() -> None:
    source = Path(argparse.__file__).read_text(encoding="utf-8")
    wordings = set(re.findall(r"_\(\s*'([^']*)'\s*\)", source)) & set(EXPECTED_WORDINGS)
    for wording in wordings:
        message = re.sub(r"%(\(\w+\))?[rs]", "int", wording)
        message = message if message.startswith(OF_NO_OPTION) else f"argument --x: {message}"
        assert "（" not in cli._in_chinese(message), message
    assert len(wordings) >= 8


OF_NO_OPTION = ("the following", "one of", "unrecognized", "ambiguous")
EXPECTED_WORDINGS = (
    "the following arguments are required: %s",
    "one of the arguments %s is required",
    "unrecognized arguments: %s",
    "expected one argument",
    "expected at most one argument",
    "expected at least one argument",
    "invalid choice: %(value)r (choose from %(choices)s)",
    "invalid %(type)s value: %(value)r",
    "not allowed with argument %s",
    "ignored explicit argument %r",
    "ambiguous option: %(option)s could match %(matches)s",
)


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


def test_a_file_that_a_command_cannot_use_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "class").mkdir()
    (tmp_path / "file").write_text("")
    arguments = ["regrade-folder", str(tmp_path / "class"), "-a", "square", "--lang", "en"]
    assert cli.run([*arguments, "--reports", str(tmp_path / "file")]) == cli.EXIT_NOT_DONE
    assert capsys.readouterr().err == f"grader: {tmp_path / 'file'}: File exists\n"


@pytest.mark.parametrize(("encoding", "title"), [("gbk", "正方形"), ("ascii", "???")])
def test_a_terminal_that_lacks_a_sign_shows_the_others(
    encoding: str, title: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(shown, encoding=encoding))
    assert cli.run(["assignments", "show", "square"]) == 0
    assert title in shown.getvalue().decode(encoding)
