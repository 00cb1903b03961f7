"""`grader` as a person at a terminal meets it."""

import json
import os
import pty
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from grader.commands import cli
from tests.e2e.grading_slot import LESSON, catalog
from tests.fakes.prepared import Prepared

Terminal = Callable[..., subprocess.CompletedProcess[str]]


def grader(*arguments: str | Path, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "grader", *map(str, arguments)],
        cwd=cwd,
        capture_output=True,
        text=True,
        check=False,
    )


def test_full_marks_end_with_0_and_a_table_in_chinese(tmp_path: Path) -> None:
    done = grader("check", LESSON / "square_mover.py", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "得分 100 / 100" in done.stdout
    assert "回到起点" in done.stdout
    assert not done.stderr


@pytest.mark.slow
def test_who_reads_no_further_gets_no_traceback(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "grader", "check", str(LESSON / "square_mover.py"), "--json"]
    reads, writes = os.pipe()
    os.close(reads)
    done = subprocess.run(command, cwd=tmp_path, stdout=writes, stderr=subprocess.PIPE, check=False)
    os.close(writes)
    assert (done.returncode, done.stderr) == (cli.EXIT_BROKEN_PIPE, b"")


def test_a_file_that_declares_its_encoding_is_read_as_python_reads_it(
    tmp_path: Path, at_terminal: Terminal
) -> None:
    script = (LESSON / "square_mover.py").read_text("utf-8").splitlines(keepends=True)
    coded = (
        script[0]
        + "# -*- coding: gb18030 -*-\n"
        + "".join(line for line in script[1:] if "coding" not in line)
    )
    (tmp_path / "coded_square.py").write_bytes(coded.encode("gb18030"))
    done = at_terminal("check", "coded_square.py")
    assert (done.returncode, done.stderr) == (0, ""), done.stdout
    assert "得分 100 / 100" in done.stdout


def test_less_than_full_marks_ends_with_1_and_the_next_step(at_terminal: Terminal) -> None:
    done = at_terminal("check", LESSON / "square_mover.py", "-a", "triangle", "--lang", "en")
    assert done.returncode == 1
    assert "Next step" in done.stdout
    assert "120°" in done.stdout


def test_whoever_sits_at_a_terminal_asks_for_each_further_hint(tmp_path: Path) -> None:
    """A pseudo-terminal, so that the grader sees a person on both sides."""
    script = tmp_path / "square.py"
    script.write_bytes(catalog().scripts("square")["wrong/one_radian.py"])
    person, terminal = pty.openpty()
    command = [sys.executable, "-m", "grader", "check", str(script), "--lang", "en"]
    with subprocess.Popen(command, cwd=tmp_path, stdin=terminal, stdout=terminal, stderr=terminal) as process:
        os.close(terminal)
        fact = _read_until(person, b"to stop: ")
        os.write(person, b"\n")
        line = _read_until(person, b"to stop: ")
        os.write(person, b"q\n")
        change = _read_until(person, b"")
    os.close(person)
    assert process.returncode == 1
    assert b"Next step" in fact
    assert (b"line " in fact.rpartition(b"Next step")[2], b"line " in line) == (False, True)
    assert b" + " not in change  # no line that is to be written


def _read_until(person: int, words: bytes) -> bytes:
    """Return what is shown up to `words`, or all of it."""
    shown = b""
    while not (words and shown.endswith(words)):
        try:
            shown += os.read(person, 1 << 16)
        except OSError:  # as Linux says that nobody is there any more
            break
    return shown


def test_the_students_own_traceback_and_nothing_else(tmp_path: Path, at_terminal: Terminal) -> None:
    script = tmp_path / "square.py"
    script.write_text("from geometry_msgs.msg import Twist\nmsg = Twist()\nmsg.linear.x = 1\n")
    done = at_terminal("check", script, "--lang", "en")
    assert done.returncode == 1
    assert "line 3, in <module>" in done.stdout
    assert "The 'x' field must be of type 'float'" in done.stdout
    assert "site-packages" not in done.stdout
    assert str(Path(sys.prefix)) not in done.stdout


def test_json_is_the_report_and_a_plot_is_written(tmp_path: Path, at_terminal: Terminal) -> None:
    done = at_terminal("check", LESSON / "square_mover.py", "--json", "--plot", "out.png")
    assert done.returncode == 0, done.stderr
    report = json.loads(done.stdout)
    assert (report["assignment"], report["score"]) == ("square", 100.0)
    assert (tmp_path / "out.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["check", "missing_square.py", "--lang", "en"], "missing_square.py: No such file"),
        (["check", "missing_square.py"], "missing_square.py：没有这个文件"),
        (["check", "."], "没有功能包"),
        (["run", "mystery.py", "--executable", "x"], "mystery.py 是脚本"),
        (["check", "/dev/zero", "-a", "square", "--lang", "en"], "more than 262144 bytes"),
        (["check", "mystery.py"], "-a square"),
        (["check", "mystery.py", "-a", "calculation"], ".txt 或 .md"),
        (["check", "mystery.py", "-a", "circle"], "circle"),
        (["check", "empty_square.py", "--lang", "en"], "empty"),
        (["check", "gbk_square.py", "--lang", "en"], "line 2 is not UTF-8"),
        (
            ["check", "gbk_square.py"],
            "第 2 行不是 UTF-8 编码（0xb7），看起来文件是 GBK（ANSI）编码。请另存为 UTF-8",
        ),
        (["check", "mystery.py", "-a", "square", "--plot", "out.gif"], ".png 或 .svg"),
        (["assignments", "show", "circle"], "circle"),
        (["assignments", "new", "heptagon"], "请用 --assignments DIR 指明"),
        (["assignments", "new", "heptagon", "--lang", "en"], "say in which folder of assignments"),
        (["check", "mystery.py", "-a", "square", "--assignments", "nowhere"], "nowhere"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_bad_input_is_one_readable_message_and_2(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: list[str],
    words: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mystery.py").write_text("print(1)\n")
    (tmp_path / "empty_square.py").write_text("")
    (tmp_path / "gbk_square.py").write_bytes("x = 1\ns = '方'\n".encode("gbk"))
    assert cli.run(arguments) == 2
    said = capsys.readouterr()
    assert words in said.err
    assert "Traceback" not in said.err
    assert not said.out


def test_the_first_assignment_makes_its_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert cli.run(["assignments", "new", "heptagon", "--assignments", "mine"]) == 0
    assert "mine/heptagon" in capsys.readouterr().out
    assert (tmp_path / "mine" / "heptagon" / "assignment.yaml").is_file()


def test_bad_input_ends_the_process_with_2(tmp_path: Path) -> None:
    done = grader("check", "missing_square.py", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert "missing_square.py：没有这个文件" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_service_that_anybody_could_reach_does_not_start(prepared: Prepared, tmp_path: Path) -> None:
    command = ["grader", "serve", "--host", "0.0.0.0", "--port", "0", "--data", str(tmp_path)]
    with prepared.start(*command) as refused:
        said = refused.stderr.read()  # all that it prints
        assert refused.wait() == 2
    assert "GRADER_ALLOW_ANONYMOUS_NETWORK" in said
    assert "Traceback" not in said


@pytest.mark.parametrize(
    "topic", ["bad topic", "cmd_vel", "/1/cmd_vel", "/a//b", "/a/", "/a\n", "/" + "a" * 247]
)
def test_no_name_of_a_topic_is_refused(capsys: pytest.CaptureFixture[str], topic: str) -> None:
    with pytest.raises(SystemExit) as ended:
        cli.run(["run", "mystery.py", "--topic", topic])
    assert ended.value.code == 2
    assert "不是话题名" in capsys.readouterr().err


def test_run_shows_logs_timeline_and_end_pose_without_grading(at_terminal: Terminal) -> None:
    done = at_terminal("run", LESSON / "square_mover.py", "--lang", "en")
    assert done.returncode == 0, done.stderr
    assert "[INFO] [1700000001.625000000] [square_mover]: 🏁 开始走正方形!" in done.stderr
    assert "t = 16.123 s" in done.stdout


def test_run_tells_what_to_do_about_a_crash_and_draws_what_was_driven(
    tmp_path: Path, at_terminal: Terminal
) -> None:
    source = (LESSON / "square_mover.py").read_text(encoding="utf-8")
    asks = source.replace("    node.destroy_node()\n", "    input('? ')\n")
    (tmp_path / "asks.py").write_text(asks, encoding="utf-8")
    done = at_terminal("run", "asks.py", "--watch", "--plot", "drive.svg")
    assert (done.returncode, "\x1b" in done.stdout) == (1, False)
    assert "t = 16.13 s" in done.stdout  # the last picture, as a pipe gets it
    assert "grader run asks.py --input" in " ".join(done.stdout.split())
    assert b"<svg" in (tmp_path / "drive.svg").read_bytes()
    assert "EOFError" in done.stderr


@pytest.mark.parametrize("name", [assignment.id for assignment in catalog().all()])
def test_the_published_rubric_names_every_item(capsys: pytest.CaptureFixture[str], name: str) -> None:
    assert cli.run(["assignments", "show", name, "--lang", "en"]) == 0
    shown = capsys.readouterr().out
    assert all(item.title.en in shown for item in catalog().get(name).items)


def test_a_text_answers_a_question(tmp_path: Path, at_terminal: Terminal) -> None:
    answer = tmp_path / "answer.txt"
    answer.write_text("4 × 3 m ÷ 1 m/s = 12 s\n", encoding="utf-8")
    done = at_terminal("check", answer, "-a", "calculation")
    assert done.returncode == 0, done.stderr
    assert "正确" in done.stdout
    waiting = at_terminal("check", answer, "-a", "theory_keep_publishing")
    assert waiting.returncode == 1
    assert "由人工评分" in waiting.stdout
    refused = at_terminal("check", answer, "-a", "square")
    assert refused.returncode == 2
    assert ".py" in refused.stderr


@pytest.mark.parametrize("settings", ["", pytest.param("/proc/none", marks=pytest.mark.slow)])
def test_a_plot_that_cannot_be_written_is_no_lost_mark(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, settings: str
) -> None:
    if settings:
        monkeypatch.setenv("MPLCONFIGDIR", settings)  # what matplotlib says to that is not shown
    (tmp_path / "out.PNG").mkdir()
    done = grader("check", LESSON / "square_mover.py", "--plot", "out.PNG", cwd=tmp_path)
    assert done.returncode == 2
    assert "得分 100 / 100" in done.stdout
    assert done.stderr == "grader: --plot out.PNG：这是文件夹，不是文件\n"


def test_without_a_command_the_commands_are_shown(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run([]) == 2
    said = capsys.readouterr()
    assert not said.out
    assert all(f"  {name} " in said.err for name in cli.COMMANDS)
