"""Look at and end a process that is not our child: its CPU clock, its threads' states, its end."""

import os
import re
import signal
import time
from contextlib import suppress

from grader.contracts.errors import SandboxError

_PID_LINE = re.compile(rb"^Pid:\t(-?\d+)$", re.MULTILINE)
_SLEEPING = frozenset(b"SITtZ")  # Z: a thread that is over, such as a main thread that left the others alone
_CPUCLOCK_SCHED = 2


class ProcessHandle:
    """A process held by its pidfd where the system has them, else by its id.

    The zygote reaps it only when told to, so the number cannot pass to another process meanwhile.

    Attributes:
        pidfd: becomes readable when the process has ended; None on systems without.
    """

    def __init__(self, pid: int, pidfd: int | None) -> None:
        self.pidfd = pidfd
        try:
            self.pid = pid if pidfd is None else _pid_in_this_namespace(pidfd)
        except SandboxError:
            self.close()
            raise
        self._clock_id = (~self.pid << 3) | _CPUCLOCK_SCHED

    def cpu_ns(self) -> int:
        """Return the CPU time of all its threads; 0 once it has been reaped or where unsupported.

        User and system time: the clock of user time alone is sampled by the kernel's tick, and misses most of a
        process that takes short turns.
        """
        try:
            return time.clock_gettime_ns(self._clock_id)
        except OSError:
            return 0

    def kill(self) -> None:
        """Send SIGKILL; not an error when it has ended already."""
        try:
            if self.pidfd is None:
                os.kill(self.pid, signal.SIGKILL)
            else:
                signal.pidfd_send_signal(self.pidfd, signal.SIGKILL)
        except ProcessLookupError:
            pass

    def sleeps(self) -> bool:
        """Return whether every thread waits for something: none runs, is ready to run, or waits for a disk.

        That tells a script that blocks itself from one that an overloaded host keeps waiting.
        """
        directory = f"/proc/{self.pid}/task"
        try:
            threads = os.listdir(directory)
            states = [_state(f"{directory}/{thread}/stat") for thread in threads]
        except OSError:
            return False
        return bool(states) and all(state in _SLEEPING for state in states)

    def threads(self) -> int:
        """Return how many threads it has; 0 where that is unknown."""
        try:
            return max(os.stat(f"/proc/{self.pid}/task").st_nlink - 2, 0)  # a directory per thread
        except OSError:
            return 0

    def waited_ns(self) -> int | None:
        """Return how long its threads were ready and got no processor; None where that is unknown.

        A thread may have waited for the others of its process, which is the script's own doing. So what they
        computed does not count: many threads that compute at once would otherwise save up time.
        """
        cpu_ns = self.cpu_ns()
        threads = _schedules(f"/proc/{self.pid}/task")
        if threads is None:
            return None
        return sum(max(delay_ns - max(cpu_ns - own_ns, 0), 0) for own_ns, delay_ns in threads)

    def close(self) -> None:
        """Release the pidfd."""
        if self.pidfd is not None:
            os.close(self.pidfd)
            self.pidfd = None


def _schedules(tasks: str) -> list[tuple[int, int]] | None:
    """Return of each thread in the directory `tasks` how long it computed and how long it waited for a processor.

    None where that is unknown.
    """
    times = []
    try:
        for thread in os.listdir(tasks):
            with suppress(FileNotFoundError, ProcessLookupError):  # it has ended meanwhile
                with open(f"{tasks}/{thread}/schedstat", "rb") as file:
                    own_ns, delay_ns = file.read().split()[:2]
                times.append((int(own_ns), int(delay_ns)))
    except (OSError, ValueError):
        return None
    return times if any(own_ns for own_ns, _ in times) else None  # zeros: this kernel keeps no account


def _state(path: str) -> int:
    with open(path, "rb") as file:
        content = file.read()
    return content[content.rindex(b")") + 2]


def _pid_in_this_namespace(pidfd: int) -> int:
    with open(f"/proc/self/fdinfo/{pidfd}", "rb") as file:
        match = _PID_LINE.search(file.read())
    if match is None or int(match[1]) <= 0:
        raise SandboxError("the confined process ended before it could be watched")
    return int(match[1])
