"""Look at and end a process that is not our child: its CPU clock, its threads' states, its end."""

import os
import re
import signal
import time

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
        """Return the CPU time of all its threads; 0 once it has been reaped or where unsupported."""
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
        """Return how long its threads were ready and got no processor; None where that is unknown."""
        return run_queue_delay_ns(f"/proc/{self.pid}/task")

    def close(self) -> None:
        """Release the pidfd."""
        if self.pidfd is not None:
            os.close(self.pidfd)
            self.pidfd = None


def run_queue_delay_ns(tasks: str) -> int | None:
    """Return how long the threads in the directory `tasks` waited for a processor; None where it is unknown."""
    total_ns = 0
    try:
        for thread in os.listdir(tasks):
            with open(f"{tasks}/{thread}/schedstat", "rb") as file:
                total_ns += int(file.read().split()[1])
    except (OSError, IndexError, ValueError):
        return None
    return total_ns


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
