"""What a forked process does to itself before the first byte of a student's code.

Standard library only: imported by the zygote. Every step raises on failure; the caller then reports and
exits, so that nothing ever runs unconfined.
"""

import fcntl
import os
import resource
import signal
import sys
from typing import NamedTuple

from . import bounds, landlock, libc, syscalls

_OPEN_MAX = 256
"""Above any descriptor the zygote ever holds; it limits itself to fewer."""


class Layers(NamedTuple):
    """What the zygote prepared for its children.

    Attributes:
        ruleset: descriptor of the Landlock rules, None where the mode does without.
        program: seccomp filter, None where the mode does without.
        box_uid: user and group id to change to, None to stay.
        keep_read: the interpreter lies where `box_uid` may not go: keep the right to read past directory
            permissions (Landlock still decides what can be read).
        namespaces: the zygote is in its own namespaces, whose capabilities must be dropped.
    """

    ruleset: int | None
    program: bytes | None
    box_uid: int | None
    keep_read: bool
    namespaces: bool


class Budget(NamedTuple):
    """Limits of one run, as the zygote is told them; `threads` None: the kernel does not count them."""

    cpu_s: float
    memory_bytes: int
    threads: int | None


def confine(layers: Layers, budget: Budget, channel: int, stdout: int, stderr: int) -> None:
    """Confine this freshly forked, single-threaded process. The order of the steps matters.

    Raises:
        OSError: a step was refused.
        ValueError: the shipped filter does not belong to this bounds.
    """
    # A group but no new session: where the kernel groups processes by session for scheduling, a new session would
    # not inherit the zygote's niceness.
    os.setpgid(0, 0)
    os.umask(0o077)
    _place_descriptors(channel, stdout, stderr)
    _limit_resources(budget)
    if sys.platform == "linux":
        _wake_without_haste()
        _drop_privileges(layers)
        libc.prctl(libc.PR_SET_DUMPABLE, 0)
        libc.prctl(libc.PR_SET_PDEATHSIG, signal.SIGKILL)
        libc.prctl(libc.PR_SET_NO_NEW_PRIVS, 1)
    if layers.ruleset is not None:  # after no_new_privs, which it requires without privileges
        landlock.restrict_self(layers.ruleset)
    os.closerange(bounds.CHANNEL_FD + 1, _OPEN_MAX)
    if layers.program is not None:  # last: it refuses the calls of the steps before
        syscalls.load(syscalls.bind_to_process(layers.program, os.getpid()))


def _place_descriptors(channel: int, stdout: int, stderr: int) -> None:
    # The passed descriptors may sit on each other's places: first above them all, then down.
    parked = [_duplicate_above(fd) for fd in (stdout, stderr, channel)]
    for place, fd in zip((1, 2, bounds.CHANNEL_FD), parked, strict=True):
        os.dup2(fd, place)
    # An open file description of its own: flags that a script sets on the zygote's would stay for the next run.
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)


def _duplicate_above(fd: int) -> int:
    return fcntl.fcntl(fd, fcntl.F_DUPFD_CLOEXEC, bounds.CHANNEL_FD + 1)


def _limit_resources(budget: Budget) -> None:
    for name, value in bounds.resource_limits(*budget).items():
        _, hard = resource.getrlimit(name)
        bound = value if hard == resource.RLIM_INFINITY else min(value, hard)
        try:
            resource.setrlimit(name, (bound, bound))
        except (OSError, ValueError):
            if sys.platform == "linux":
                raise  # macOS, in dev mode, lacks some of them


def _wake_without_haste() -> None:
    """Let a thread that is handed the turn not interrupt the one that hands it over, and is about to wait."""
    try:
        os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
    except OSError:
        return  # a host may forbid it; it is only for speed


def _drop_privileges(layers: Layers) -> None:
    if layers.box_uid is not None:
        if layers.keep_read:
            libc.prctl(libc.PR_SET_KEEPCAPS, 1)
        os.setgroups([])
        os.setresgid(layers.box_uid, layers.box_uid, layers.box_uid)
        os.setresuid(layers.box_uid, layers.box_uid, layers.box_uid)
    keep = layers.box_uid is not None and layers.keep_read
    if layers.namespaces or layers.box_uid is not None or os.geteuid() == 0:
        libc.set_capabilities(1 << libc.CAP_DAC_READ_SEARCH if keep else 0)
