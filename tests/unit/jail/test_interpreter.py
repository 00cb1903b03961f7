"""The zygote's interpreter, before it is told anything."""

import subprocess
import sys
from pathlib import Path
from typing import NoReturn

import pytest

from grader.jail import supervisor

_NICE_PARENT = """
import os
from pathlib import Path
from grader.jail import supervisor

os.setpriority(os.PRIO_PROCESS, 0, 7)
for _ in range(2):  # without privileges the kernel accepts one request in 0.1 s
    interpreter = supervisor.start_interpreter()
    print(Path(f"/proc/{interpreter.pid}/autogroup").read_text())
    interpreter.end()
"""


@pytest.mark.skipif(
    not Path("/proc/self/autogroup").exists(), reason="this kernel does not group processes by session"
)
def test_it_gives_way_as_much_as_the_process_that_started_it() -> None:
    parent = subprocess.run([sys.executable, "-c", _NICE_PARENT], capture_output=True, text=True, check=True)
    assert [line.split()[1:] for line in parent.stdout.splitlines() if line] == [["nice", "7"]] * 2


@pytest.mark.parametrize(
    ("answers", "asked"),
    [
        pytest.param([FileNotFoundError()], 1, id="a kernel that does not group"),
        pytest.param(
            [BlockingIOError(), PermissionError()], 2, id="others asked just before, then a refusal"
        ),
        pytest.param([BlockingIOError()] * 50, 10, id="others ask all the time"),
    ],
)
def test_a_kernel_that_does_not_let_it_give_way_is_not_asked_for_ever(
    answers: list[OSError], asked: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked_for = []

    def refuse(path: str, *_mode: object, **_options: object) -> NoReturn:
        asked_for.append(path)
        raise answers[len(asked_for) - 1]

    monkeypatch.setattr(supervisor, "open", refuse, raising=False)
    monkeypatch.setattr(supervisor.time, "sleep", lambda _s: None)
    supervisor.yield_session(4_711, 7)
    assert asked_for == ["/proc/4711/autogroup"] * asked
