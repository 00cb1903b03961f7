"""Progress of a long command: for a terminal only, and only on standard error."""

import io
import re
from contextlib import closing

import pytest

from grader.render.progress import followed

_LINE_CLEARED = "\x1b[?25h\r\x1b[1A\x1b[2K"  # cursor shown again, a line up, deleted


class _Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True

    def plain(self) -> str:
        return re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", "", self.getvalue())


@pytest.fixture
def plain_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("FORCE_COLOR", "TTY_COMPATIBLE", "TTY_INTERACTIVE", "NO_COLOR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("TERM", "xterm")


@pytest.mark.usefixtures("plain_environment")
def test_a_terminal_sees_what_is_under_way(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    terminal = _Terminal()
    monkeypatch.setattr("sys.stderr", terminal)
    with closing(followed(["hello", "square", "spin"])) as names:
        assert next(names) == "hello"
        assert "0/3 hello" in terminal.plain()
        assert next(names) == "square"
        assert "1/3 square" in terminal.plain()
    assert terminal.getvalue().endswith(_LINE_CLEARED), "left half done it gives the line back, too"
    assert capsys.readouterr().out == ""


@pytest.mark.usefixtures("plain_environment")
def test_a_file_or_pipe_gets_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    assert list(followed(["hello", "square"])) == ["hello", "square"]
    assert capsys.readouterr() == ("", "")
