"""Processes with the shim loaded, forked from one that has done nothing else: a third of an interpreter's start.

So does the grader's own zygote; what a script finds is what a fresh interpreter would have imported for it.
"""

import array
import atexit
import os
import signal
import socket
import subprocess
from functools import cache

HANG_S = 120.0
"""A script that still runs after this long is blocked outside virtual time: a bug of the shim."""

COMMAND = ("-s", "-P", "-S", "-B", "-c")
"""Isolates the interpreter as in the jail (`-I` would ignore PYTHONHASHSEED); the program follows."""

_PROGRAM = """
import gc, os, resource, sys, _socket
del sys.modules["resource"]  # a script finds it where `load` brings it, and imports it itself elsewhere
del sys.modules["gc"]
{load}
gc.collect()
gc.freeze()  # a fork that collects garbage would copy the pages of all that was imported
control = _socket.socket(_socket.AF_UNIX, _socket.SOCK_STREAM, 0, {control})
while True:
    asked, passed, _, _ = control.recvmsg(32, _socket.CMSG_SPACE(12))
    if not asked:
        os._exit(0)
    files = memoryview(passed[0][2]).cast("i").tolist()
    pid = os.fork()
    if pid == 0:
        break
    for file in files:
        os.close(file)
    control.send(b"%d" % os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]))
control.close()
channel, out, err = files
os.dup2(out, 1)
os.dup2(err, 2)
os.close(out)
os.close(err)
resource.setrlimit(resource.RLIMIT_CPU, (int(asked), int(asked)))
runner.run(channel)
"""


class Forks:
    """One process that others are forked from, until this process ends."""

    def __init__(self, python: str, load: str) -> None:
        """Start it; `load` is the statement that brings `runner`."""
        self._control, theirs = socket.socketpair()
        self._control.settimeout(HANG_S)
        with theirs:
            self._process = subprocess.Popen(
                [python, *COMMAND, _PROGRAM.format(load=load, control=theirs.fileno())],
                stdin=subprocess.DEVNULL,
                pass_fds=(theirs.fileno(),),
                env={"PYTHONHASHSEED": "0"},
                cwd="/",
                start_new_session=True,
            )
        atexit.register(self.close)

    def run(self, channel: int, out: int, err: int, cpu_s: float) -> None:
        """Let a fork run what START on `channel` says; close these descriptors here when this returns."""
        files = array.array("i", (channel, out, err))
        self._control.sendmsg([b"%.0f" % cpu_s], [(socket.SOL_SOCKET, socket.SCM_RIGHTS, files)])

    def wait(self) -> int:
        """Wait for the fork; return its exit code.

        Raises:
            TimeoutError: it hangs, and was killed.
        """
        try:
            return int(self._control.recv(32))
        except TimeoutError:
            self.close()
            forks.cache_clear()
            raise

    def close(self) -> None:
        """End it, and what hangs."""
        self._control.close()
        if self._process.poll() is None:
            os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()


@cache
def forks(python: str, load: str) -> Forks:
    """Return the one of this process."""
    return Forks(python, load)
