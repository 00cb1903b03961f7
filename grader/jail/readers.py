"""Running a process of the grader that reads an upload, and deciding whose fault it is if it does not answer.

The process bounds itself by `limit`. If it then runs out of memory, or the kernel ends it for its CPU time, the
upload is at fault. If it reaches the wall limit, the host had no time for it, because reading never waits for
anything; and only the host sends SIGKILL. After such a fault of the host the upload may be read a minute later.
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
    """Bound this process. The kernel ends it by SIGXCPU when its CPU time is used up, and for no other reason."""
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
        command: the reader and its arguments.
        content: given to its standard input.
        most_bytes: bound on its answer.
        environment: of the reader; None: that of this process.
        wall_limit_s: at least three times its CPU time, so that no upload reaches it, only a busy host.

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
