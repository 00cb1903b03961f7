"""Start the grading process.

It takes a tenth of a second to import the physics, so `grader check` starts it before anything else. That is why
this module imports little, and why the process is told its configuration afterwards.
"""

import fcntl
import os
import sys

_KEPT_ENVIRONMENT = ("PATH", "HOME", "LANG", "TMPDIR", "PYTHONPATH", "VIRTUAL_ENV")
_SINGLE_THREADED = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
"""Trajectories are short: threads of a BLAS would only cost their start, and its sums would depend on them."""

_LARGE_PAGES = {"GLIBC_TUNABLES": "glibc.malloc.hugetlb=1"}
"""Bullet asks for 25 MiB when it is connected to: a few huge pages come in half the time of 7,000 small ones."""

_ANSWER_BYTES = 1 << 20
"""A report comes with some 150 KB of motion. In a pipe of 64 KiB each process waits for the other several times:
on a busy machine that took a tenth of a warm grading."""

_ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
_PYTHON = (sys.executable, "-I", "-S", "-c")  # what `site` would find out once more stands in our own path
_BOOTSTRAP = (  # nothing is imported, and no garbage collected, before this
    "import gc, os, sys; gc.disable(); sys.path[:] = sys.argv.pop(1).split(os.pathsep); "
    "from grader.grading.child import main; sys.exit(main(sys.argv[1:]))"
)


class Child:
    """A grading process that has been started.

    Attributes:
        pid: also the number of its process group.
        requests: descriptor to write requests to. answers: descriptor to read its answers from.
    """

    __slots__ = ("answers", "pid", "requests")

    def __init__(self, pid: int, requests: int, answers: int) -> None:
        self.pid = pid
        self.requests = requests
        self.answers = answers


_ahead: list[Child] = []


def launch_ahead() -> None:
    """Start a process for the first `launch` to come. If none comes, it ends together with this one.

    When it cannot be started, that `launch` will tell.
    """
    try:
        _ahead.append(_start())
    except OSError:
        return


def launch() -> Child:
    """Return a process started ahead, or start one. Raises OSError: it could not be started."""
    return _ahead.pop() if _ahead else _start()


def import_path() -> str:
    """Return the import path of this process without its first entry, the folder of its script or the current one.

    A student's ``random.py`` may lie there. In Python's safe-path mode there is no such entry.
    """
    own = [entry for entry in (sys.path if getattr(sys.flags, "safe_path", False) else sys.path[1:]) if entry]
    return os.pathsep.join(own if _ROOT in own else [_ROOT, *own])


def _widen(pipe: int) -> None:
    """Let a pipe hold a whole answer, where the system allows it."""
    try:
        fcntl.fcntl(pipe, fcntl.F_SETPIPE_SZ, _ANSWER_BYTES)
    except (AttributeError, OSError):  # not Linux, or this user's pipes hold too much already
        return


def _start() -> Child:
    theirs_requests, requests = os.pipe()
    answers, theirs_answers = os.pipe()
    _widen(answers)
    environment = {name: os.environ[name] for name in _KEPT_ENVIRONMENT if name in os.environ}
    try:
        pid = os.posix_spawn(
            sys.executable,
            [*_PYTHON, _BOOTSTRAP, import_path(), str(theirs_requests), str(theirs_answers)],
            environment | _SINGLE_THREADED | _LARGE_PAGES,
            file_actions=[
                (os.POSIX_SPAWN_OPEN, 0, os.devnull, os.O_RDONLY, 0),
                # Onto itself: the one way to hand on a descriptor without other threads' children getting it.
                (os.POSIX_SPAWN_DUP2, theirs_requests, theirs_requests),
                (os.POSIX_SPAWN_DUP2, theirs_answers, theirs_answers),
            ],
            setsid=True,  # Ctrl+C in a terminal is for the parent, which then drains
        )
    except OSError:
        os.close(requests)
        os.close(answers)
        raise
    finally:
        os.close(theirs_requests)
        os.close(theirs_answers)
    return Child(pid, requests, answers)
