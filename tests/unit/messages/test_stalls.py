"""Why a script stalled is told in both languages."""

import re

import pytest

from grader.messages.details import stall

ANSWER = "waits for an answer, but no executor spins the node in another thread to receive it"
RATE = "rate.sleep() waits for a timer of its node, but nothing spins that node in another thread"


@pytest.mark.parametrize(
    ("detail", "chinese"),
    [
        (f"main thread, line 12: {RATE}", "主线程 第 12 行：rate.sleep() 在等"),
        (f"T, line 3: Client.call() {ANSWER}",
         "Client.call() 在等服务的回应"),
        ("MainThread, line 5: spin_once() waits for a timer, a message or a request, but nothing of that can come",
         "spin_once() 在等"),
        (f"T, line 3: client.call() of '/turtle1/x' {ANSWER}",
         "client.call() of '/turtle1/x' 在等服务的回应"),
        ("T: wait_for_message() waits for a message on '/x'", "话题 '/x'"),
        ("MainThread: the end of the program waits for the other threads", "程序末尾"),
        ("MainThread, line 9: Lock.acquire() waits for ever", "Lock.acquire() 永远等不到"),
    ],
)  # fmt: skip
def test_known_reasons(detail: str, chinese: str) -> None:
    text = stall(detail)
    assert chinese in text.zh
    assert text.en == detail
    assert not re.search("[a-z]{3,} (waits|for|the) ", text.zh)


@pytest.mark.parametrize("detail", ["", "something else", "a; b: c", "T, line x: y", "；: ; :"])
def test_anything_else_is_quoted(detail: str) -> None:
    assert stall(detail).en == detail


def test_several_threads() -> None:
    text = stall(f"MainThread, line 4: {RATE}; Thread-1: Event.wait() waits for ever")
    assert "；Thread-1：Event.wait() 永远等不到结果" in text.zh
