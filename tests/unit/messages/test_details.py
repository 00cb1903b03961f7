"""What the machinery says about a run, told in the reader's language."""

import ast
from pathlib import Path

import pytest

import grader
from grader.contracts.outcome import RunStatus
from grader.contracts.text import EMPTY
from grader.messages.details import explained


@pytest.mark.parametrize(
    ("status", "detail", "chinese", "english"),
    [
        (
            RunStatus.FORBIDDEN,
            "open for writing: /tmp/a\nb",
            "写文件 /tmp/a\nb",
            "writing the file /tmp/a\nb",
        ),
        (RunStatus.FORBIDDEN, "os.system: ls", "启动别的程序：os.system: ls", "starting another program"),
        (RunStatus.FORBIDDEN, "os.fork", "启动别的程序：os.fork", "os.fork"),
        (RunStatus.FORBIDDEN, "socket.connect: <socket>", "使用网络", "using the network"),
        (RunStatus.FORBIDDEN, "a system call of another architecture was made", "系统调用", "architecture"),
        (RunStatus.PROTOCOL, "RESPONSE.sequence 1 is not awaited", "干扰", "interfered"),
        (RunStatus.CPU_LIMIT, "more than 7.5 s of CPU time were used", "超过 7.5 秒", "7.5 s"),
        (RunStatus.CPU_LIMIT, "more than 1500 steps were made", "超过 1500 步", "1500 steps"),
        (RunStatus.OUTPUT_LIMIT, "more than 65536 bytes were printed", "64 KiB", "64 KiB"),
        (RunStatus.OUTPUT_LIMIT, "more than 4194304 bytes were printed", "4 MiB", "4 MiB"),
        (RunStatus.OUTPUT_LIMIT, "more than 1000 bytes were printed", "1000 B", "1000 B"),
        (RunStatus.CRASHED, "the process was ended by SIGSEGV", "信号 SIGSEGV", "SIGSEGV"),
        (RunStatus.STALLED, "main, line 4: f() waits for ever", "f() 永远等不到", "f() waits for ever"),
        (RunStatus.CRASHED, "something {new}", "something {new}", "something {new}"),
    ],
)
def test_known_sentences_are_told_in_both_languages(
    status: RunStatus, detail: str, chinese: str, english: str
) -> None:
    text = explained(status, detail)
    assert chinese in text.zh
    assert english in text.en


def test_nothing_is_nothing() -> None:
    assert explained(RunStatus.CRASHED, "") == EMPTY


def refused_calls() -> list[str]:
    """Return what the script's process refuses; it shares no module with the grader's."""
    source = (Path(grader.__file__).parent / "shim" / "rclpy" / "_patches" / "audit.py").read_text()
    found = next(node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Set))
    return sorted(ast.literal_eval(found))


@pytest.mark.parametrize("call", refused_calls())
def test_every_call_that_is_refused_has_words(call: str) -> None:
    assert explained(RunStatus.FORBIDDEN, call).zh != call
