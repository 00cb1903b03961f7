"""Whose fault it is when a process that reads an upload does not answer."""

import sys

import pytest

from grader.contracts.errors import InfrastructureError
from grader.jail.readers import TooMuchError, answer_of

BOUNDED = "from grader.jail.readers import limit; limit(512 * 1024**2, 1);"


def answer(code: str, wall_limit_s: float = 60.0) -> tuple[int, bytes]:
    return answer_of([sys.executable, "-c", code], b"in", most_bytes=10, wall_limit_s=wall_limit_s)


def test_an_answer_and_what_it_says_of_the_upload() -> None:
    assert answer("import sys; sys.stdout.write(sys.stdin.read()); sys.exit(3)") == (3, b"in")


@pytest.mark.parametrize(
    "code",
    [
        BOUNDED + "\nwhile True: pass",
        BOUNDED + "import os; os.abort()",  # as a library ends that found no memory
        "print('x' * 11)",
    ],
    ids=["time", "memory", "answer"],
)
def test_what_takes_too_much_is_the_uploads_fault(code: str) -> None:
    with pytest.raises(TooMuchError):
        answer(code)


@pytest.mark.parametrize(
    ("code", "told"),
    [
        ("import os, signal; os.kill(os.getpid(), signal.SIGKILL)", "killed from outside"),
        ("import signal; signal.pause()", "no time"),
        ("raise ValueError('a mistake of ours')", "a mistake of ours"),
    ],
    ids=["killed", "no time", "failed"],
)
def test_what_the_host_does_is_not(code: str, told: str) -> None:
    with pytest.raises(InfrastructureError, match=told):
        answer(code, wall_limit_s=0.5 if "pause" in code else 60.0)


def test_a_reader_that_cannot_be_started() -> None:
    with pytest.raises(InfrastructureError, match="could not be started"):
        answer_of(["/nowhere/python"], most_bytes=10)
