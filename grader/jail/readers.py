"""Processes of the grader's own that read what somebody uploaded, and whose fault it is when one does not answer.

Such a process bounds itself by `limit`. What it does then is the upload's doing: it runs out of memory, or the
kernel ends it for the CPU time it used. A wall limit that is reached says that the host had no time for it,
because reading waits for nothing; and nobody but the host sends SIGKILL. A minute later it may be read.
"""

import resource
import signal
import subprocess
from collections.abc import Mapping, Sequence
from typing import Final

from grader.contracts.errors import InfrastructureError

WALL_LIMIT_S: Final = 60.0
_GRACE_S: Final = 1


class TooMuchError(Exception):
    """Reading took more memory, time or room for its answer than there is for an upload."""


def limit(memory_bytes: int, cpu_s: int) -> None:
    """Bound this process; beyond the CPU time the kernel ends it by SIGXCPU, which only that means."""
    resource.setrlimit(resource.RLIMIT_AS, (memory_bytes, memory_bytes))
    resource.setrlimit(resource.RLIMIT_CPU, (cpu_s, cpu_s + _GRACE_S))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def answer_of(
    command: Sequence[str],
    content: bytes = b"",
    *,
    most_bytes: int,
    environment: Mapping[str, str] | None = None,
    wall_limit_s: float = WALL_LIMIT_S,
) -> tuple[int, bytes]:
    """Run a reader; return its exit code and what it wrote.

    Args:
        command: to be run.
        content: for its standard input.
        most_bytes: of its answer.
        environment: None: that of this process.
        wall_limit_s: three times its CPU time at least: a busy host reaches it, and no upload does.

    Raises:
        TooMuchError: the upload takes too much.
        InfrastructureError: it could not be started, or the host ended it or gave it no time.
    """
    try:
        done = subprocess.run(  # noqa: S603 - a program of the grader's own
            command, input=content, capture_output=True, timeout=wall_limit_s, check=False, env=environment
        )
    except subprocess.TimeoutExpired:
        raise InfrastructureError(
            f"the reader of uploads had no time to answer within {wall_limit_s:g} s"
        ) from None
    except OSError as error:
        raise InfrastructureError(f"the reader of uploads could not be started: {error}") from error
    if done.returncode == -signal.SIGKILL:
        raise InfrastructureError("the reader of uploads was killed from outside the grader")
    if done.returncode < 0 or len(done.stdout) > most_bytes:
        raise TooMuchError
    if done.returncode == 1:  # Python's own, after a traceback
        raise InfrastructureError(f"the reader of uploads failed: {done.stderr[-500:]!r}")
    return done.returncode, done.stdout
