"""Start the zygote's interpreter.

It gets ready on another core while the physics is imported, for about as long. What it is to do it is told
afterwards (`supervisor.Zygote`).
"""

import _socket
import os
import signal
import sys
import time
from typing import Final

from grader.jail import libc, policy

_LAUNCHER: Final = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
# Nothing but the standard streams and the control socket may stay open, whatever this process inherited.
_BOOTSTRAP: Final = (
    "import os, sys; control = int(sys.argv[-1]); os.closerange(3, control); "
    "os.closerange(control + 1, os.sysconf('SC_OPEN_MAX')); os.chdir('/'); "
    "sys.path.insert(0, sys.argv.pop(1)); from jail.zygote import main; main()"
)
_BETWEEN_WISHES_S: Final = 0.11
_WISHES: Final = 10


class Interpreter:
    """A started interpreter that waits for its configuration.

    Attributes:
        pid: our child, in a session of its own.
        control: our end of the socket it obeys.
    """

    def __init__(self, pid: int, control: _socket.socket) -> None:
        self.pid = pid
        self.control = control
        self._ended = False

    @property
    def alive(self) -> bool:
        """Whether it still runs; once it does not, it is reaped."""
        self._ended = self._ended or os.waitpid(self.pid, os.WNOHANG)[0] != 0
        return not self._ended

    def kill(self) -> None:
        """Send SIGKILL, unless it has ended."""
        if self.alive:
            os.kill(self.pid, signal.SIGKILL)

    def end(self) -> None:
        """Close the socket, kill the process and reap it."""
        self.control.close()
        self.kill()
        self.wait()

    def wait(self) -> None:
        """Wait for its end."""
        if not self._ended:
            os.waitpid(self.pid, 0)
            self._ended = True


def spawn() -> Interpreter:
    """Start the interpreter with almost no environment.

    ``-P -s -S`` with the fixed environment isolate as ``-I -S`` does; ``-I`` would ignore PYTHONHASHSEED.

    Raises:
        OSError: it could not be started.
    """
    executable = os.path.realpath(sys.executable)
    ours, theirs = _socket.socketpair(_socket.AF_UNIX, _socket.SOCK_STREAM)
    control = theirs.fileno()
    command = [executable, "-P", "-s", "-S", "-X", "utf8", "-c", _BOOTSTRAP, _LAUNCHER, str(control)]
    try:
        with _FixedAddresses():
            pid = os.posix_spawn(
                executable,
                command,
                policy.ENVIRONMENT,
                file_actions=[
                    (os.POSIX_SPAWN_OPEN, 0, os.devnull, os.O_RDONLY, 0),
                    (os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0),
                    (os.POSIX_SPAWN_DUP2, control, control),  # onto itself: handed on to this child alone
                ],
                setsid=True,
            )
    except OSError:
        ours.close()
        raise
    finally:
        theirs.close()
    if niceness := os.getpriority(os.PRIO_PROCESS, 0):  # a session of its own does not take after ours
        yield_session(pid, niceness)
    return Interpreter(pid, ours)


def yield_session(pid: int, niceness: int) -> None:
    """Let every other session go before the one that process `pid` has begun.

    Where the kernel groups processes by session (autogroup), a process's own niceness counts only inside its
    session (sched(7)). From whoever is no administrator the kernel takes one such wish in a tenth of a second, on
    the whole machine; who starts at the same time as others asks again for a while.
    """
    for _ in range(_WISHES):
        try:
            with open(f"/proc/{pid}/autogroup", "w", encoding="ascii") as file:
                file.write(str(niceness))
            return
        except BlockingIOError:
            time.sleep(_BETWEEN_WISHES_S)
        except OSError:
            return  # this kernel does not group


class _FixedAddresses:
    """Switch address randomisation off for processes started inside, as far as the host allows.

    ``<object at 0x7f...>`` in a script's output, and the order of sets of objects, are then the same in
    every run. This gives up no boundary: the script may read its own memory anyway, and what keeps it in
    is enforced by the kernel. Ordinary containers refuse the call; then addresses differ between zygotes.
    """

    def __enter__(self) -> None:
        self._former: int | None = None
        try:
            former = libc.personality(libc.PERSONALITY_QUERY)
            libc.personality(former | libc.ADDR_NO_RANDOMIZE)
            self._former = former
        except (OSError, AttributeError):
            return

    def __exit__(self, *_: object) -> None:
        if self._former is not None:
            libc.personality(self._former)
