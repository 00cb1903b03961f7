"""Other programs: none is started here.

What only tidies the screen is done by doing nothing; a turtlesim that a script starts is taken for the one that is
there. Anything else `os.system` does not find, as a shell without programs would not, and `subprocess` is refused.
"""

from __future__ import annotations

import itertools
import os
import sys

from rclpy._kernel import kernel
from rclpy._link import link
from rclpy._patches import host

TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import ModuleType
    from typing import Any

SCREEN = frozenset({"clear", "cls", "reset", "tput", "stty"})
TERMINALS = frozenset({"gnome-terminal", "xterm", "x-terminal-emulator", "konsole", "terminator", "nohup"})
TURTLESIM = "turtlesim_node"

FIRST_PID = 4300
NOT_FOUND = 127


def words_of(command: Any) -> list[str]:
    """Return the words of a command line, or of a list of them; empty when it is neither."""
    if isinstance(command, (str, bytes, os.PathLike)):
        return os.fsdecode(command).replace("&", " & ").split()
    try:
        return [os.fsdecode(word) for word in command]
    except TypeError:
        return []


def is_for_the_screen(words: list[str]) -> bool:
    """Return whether a command does no more than tidy the terminal."""
    return bool(words) and os.path.basename(words[0]) in SCREEN


def is_turtlesim(words: list[str]) -> bool:
    """Return whether a command starts turtlesim."""
    return bool(words) and any(os.path.basename(word) == TURTLESIM for word in words)


def system(command: Any) -> int:
    """`os.system`."""
    words = words_of(command)
    if not words or is_for_the_screen(words):
        return 0
    if is_turtlesim(words):
        if "&" not in words and os.path.basename(words[0]) not in TERMINALS:
            kernel.wait(_never, None, "os.system() waits for turtlesim to be closed", idle=True)
        return 0
    link.note("forbidden", f"os.system: {' '.join(words)}")
    print(f"sh: 1: {words[0]}: not found", file=sys.stderr)  # noqa: T201
    return NOT_FOUND << 8


def _never() -> bool:
    return False


_programs: dict[int, Any] = {}
"""Programs that the script believes to run, by process id; each leads a group of its own."""
_numbers = itertools.count(FIRST_PID + 1)


def kill(pid: int, number: int, /) -> None:
    """`os.kill`, also for a program that the script only believes to run."""
    if pid not in _programs:
        host.kill(pid, number)
    elif number:
        _programs[pid].send_signal(number)


def getpgid(pid: int, /) -> int:
    return pid if pid in _programs else host.getpgid(pid)


REPLACED: dict[str, object] = {"getpgid": getpgid, "kill": kill, "killpg": kill, "system": system}
"""What replaces the functions of `os`, by name."""


def patch_subprocess(subprocess: ModuleType) -> None:
    """Make `Popen` accept the programs that need not be started."""
    module: Any = subprocess
    real: Any = module.Popen

    class Popen(real):  # type: ignore[misc]
        """A program that ends at once, or a turtlesim that runs until it is told to end."""

        def _execute_child(self, args: Any, *rest: Any) -> None:
            words = words_of(args)
            self._runs = is_turtlesim(words)
            if not self._runs and not is_for_the_screen(words):
                super()._execute_child(args, *rest)
                return
            self._close_pipe_fds(*rest[9:15])  # the program's ends; files that the script gave stay open
            self._child_created = True
            self.pid = next(_numbers)
            if self._runs:
                _programs[self.pid] = self
            self.returncode = None if self._runs else 0

        def _internal_poll(self, *rest: Any, **options: Any) -> int | None:
            code: int | None = self.returncode
            return code

        def send_signal(self, sig: int) -> None:
            if self.returncode is None:
                self.returncode = -int(sig)

        def _wait(self, timeout: float | None) -> int:
            deadline_ns = None if timeout is None else kernel.now_ns + round(timeout * 1e9)
            why = "wait() waits for turtlesim to be closed"
            if not kernel.wait(lambda: self.returncode is not None, deadline_ns, why, idle=True):
                raise module.TimeoutExpired(self.args, timeout)
            return self.returncode or 0

    Popen.__module__, Popen.__qualname__ = "subprocess", "Popen"
    module.Popen = Popen
