"""Processes like those of `python -m`, each forked from one that has imported what the service needs.

Importing takes a second and a half, more than most of what the tests of several processes let one do. How a
process starts by itself is tested elsewhere (`tests/e2e/test_serve.py`, `test_command_line.py`).
"""

import gc
import json
import os
import runpy
import select
import signal
import socket
import subprocess
import sys
from contextlib import suppress
from importlib import import_module
from io import TextIOWrapper
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
_NEEDED = (
    "grader.api",
    "grader.commands.serve",
    "grader.commands.storage",
    "grader.commands.worker",
    "grader.service.composition",
    "grader.live.protocol",
    "grader.store.jobs.news",
    "uvicorn.main",
)
_MOST_BYTES = 1 << 17
_NUMBER_BYTES = 4


class Forked:
    """A process, to be used as a `subprocess.Popen`.

    Attributes:
        pid: of the process.
        stderr: what it prints, there or to its standard output, is read here, unless it goes to a file.
    """

    def __init__(self, told: int, stderr: TextIOWrapper) -> None:
        self.pid = _number(told)
        self.stderr = stderr
        self._told = told
        self._code: int | None = None

    def __enter__(self) -> "Forked":
        return self

    def __exit__(self, *_: object) -> None:
        self.kill()
        self.wait()
        os.close(self._told)
        self.stderr.close()

    def send_signal(self, number: int) -> None:
        """Send a signal, unless the process has ended."""
        if self._code is None and not select.select([self._told], [], [], 0)[0]:
            with suppress(ProcessLookupError):
                os.kill(self.pid, number)

    def kill(self) -> None:
        """End the process at once."""
        self.send_signal(signal.SIGKILL)

    def wait(self, timeout: float | None = None) -> int:
        """Return its exit code; of one that a signal ended, that one's number below zero."""
        if self._code is None:
            if not select.select([self._told], [], [], timeout)[0]:
                raise TimeoutError("the process has not ended")
            self._code = _number(self._told)
        return self._code


class Prepared:
    """The process that others are forked from."""

    def __init__(self) -> None:
        self._control, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with theirs:
            self._origin = subprocess.Popen(
                [sys.executable, "-m", "tests.fakes.prepared", str(theirs.fileno())],
                cwd=ROOT,
                stdin=subprocess.DEVNULL,
                pass_fds=[theirs.fileno()],
            )

    def start(self, *command: str, log: int | None = None, **environment: str) -> Forked:
        """Start a process.

        Args:
            command: a module, which is run as `python -m` does, and its arguments.
            log: the file that takes what it prints.
            environment: what it has beside this process's variables.
        """
        told, says = os.pipe()
        read, written = os.pipe()
        request = {"command": command, "environment": {**os.environ, **environment}}
        files = [says, written if log is None else log]
        socket.send_fds(self._control, [json.dumps(request).encode()], files)
        os.close(says)
        os.close(written)
        return Forked(told, os.fdopen(read))

    def close(self) -> None:
        """Start no more processes."""
        self._control.close()
        self._origin.wait()


def _number(told: int) -> int:
    number = os.read(told, _NUMBER_BYTES)
    assert len(number) == _NUMBER_BYTES
    return int.from_bytes(number, "little", signed=True)


def _next_command(control: socket.socket) -> list[str]:
    """Return in each process that is asked for, with what it shall do; in this one with nothing, in the end."""
    while True:
        asked, files, _, _ = socket.recv_fds(control, _MOST_BYTES, 2)
        if not asked:
            return []
        if os.fork() == 0:
            control.close()
            _watch(*files)
            request = json.loads(asked)
            os.environ.clear()
            os.environ.update(request["environment"])
            return request["command"]
        for one in files:
            os.close(one)


def _watch(says: int, log: int) -> None:
    """Return in a process that this one starts, tells the number of, and waits for, to tell how it ended."""
    pid = os.fork()
    if pid == 0:
        os.dup2(log, 1)
        os.dup2(log, 2)
    os.close(log)
    if pid == 0:
        os.close(says)
        return
    os.closerange(1, 3)
    os.write(says, pid.to_bytes(_NUMBER_BYTES, "little"))
    code = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
    os.write(says, code.to_bytes(_NUMBER_BYTES, "little", signed=True))
    os._exit(0)


def _main() -> None:
    control = socket.socket(fileno=int(sys.argv.pop()))
    gc.disable()
    for name in _NEEDED:
        import_module(name)
    gc.freeze()
    command = _next_command(control)
    if command:
        # The old one may have been a file, which this is not.
        sys.stdout = open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115 - open until the process ends
        gc.enable()
        sys.argv[:] = command
        runpy.run_module(command[0], run_name="__main__", alter_sys=True)
    else:
        with suppress(
            ChildProcessError
        ):  # all have ended, and their times are known to who waits for this process
            while os.wait():
                pass


if __name__ == "__main__":
    _main()
