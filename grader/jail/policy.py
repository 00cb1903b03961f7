"""The sandbox's policy in one readable place: system calls, resource limits, readable paths, environment.

Everything not named here is refused. Pure data and arithmetic, standard library only: both the zygote and
the supervisor import it. After changing `SYSCALLS` run ``python -m grader.jail.compiler`` to rebuild the
filters that are shipped; a test rebuilds and compares them.
"""

import errno
import math
import resource
from typing import Final

MIB: Final = 1024 * 1024
CHANNEL_FD: Final = 3

# ------------------------------------------------------------------------------------------ system calls

OWN_PID: Final = 0x5A17C0DE
"""Stands for the process's own id in a shipped filter; replaced when the filter is loaded."""


Arg = tuple[int, int, int]
"""A condition (index, value, mask) on one argument: ``argument[index] & mask == value``; mask 0: all bits."""

Rule = tuple[Arg, ...]
"""Conditions that must all hold."""

ANY: Final[tuple[Rule, ...]] = ((),)

_LOW_32: Final = 0xFFFF_FFFF  # the kernel ignores the upper half of these arguments, so the filter must too
_CLONE_VM, _CLONE_SIGHAND, _CLONE_THREAD = 0x100, 0x800, 0x10000
_CLONE_NAMESPACES: Final = 0x7E020080
_THREAD: Final = _CLONE_VM | _CLONE_SIGHAND | _CLONE_THREAD
_AF_UNIX, _SOCK_STREAM = 1, 1
# INT QUIT ILL ABRT BUS FPE USR1 SEGV USR2 ALRM TERM: never KILL or STOP.
_SELF_SIGNALS: Final = (2, 3, 4, 6, 7, 8, 10, 11, 12, 14, 15)


def _one_of(index: int, values: tuple[int, ...]) -> tuple[Rule, ...]:
    return tuple(((index, value, _LOW_32),) for value in values)


_FILES = ("read readv pread64 preadv write writev pwrite64 lseek close fstat newfstatat statx openat open "
          "stat lstat access faccessat faccessat2 readlink readlinkat getdents64 getcwd chdir dup dup2 dup3 "
          "pipe pipe2 fsync")  # fmt: skip
_MEMORY = "mmap mprotect munmap mremap madvise brk"
_THREADS = ("futex rseq set_robust_list set_tid_address exit exit_group rt_sigaction rt_sigprocmask "
            "rt_sigreturn rt_sigpending sigaltstack restart_syscall sched_yield sched_getaffinity getcpu "
            "membarrier")  # fmt: skip
_TIME = "clock_gettime clock_getres gettimeofday time times nanosleep clock_nanosleep"
_WAITING = ("poll ppoll select pselect6 epoll_create1 epoll_create epoll_ctl epoll_wait epoll_pwait "
            "epoll_pwait2 eventfd2 pause")  # fmt: skip
_IDENTITY = ("getpid getppid gettid getuid geteuid getgid getegid getresuid getresgid getgroups getpgid "
             "getpgrp getsid uname sysinfo getrusage getrlimit getrandom")  # fmt: skip
_SOCKETS = "recvfrom getsockname getpeername getsockopt shutdown"

SYSCALLS: Final[dict[str, tuple[Rule, ...]]] = {
    **dict.fromkeys(" ".join((_FILES, _MEMORY, _THREADS, _TIME, _WAITING, _IDENTITY, _SOCKETS)).split(), ANY),
    # Threads yes, processes and namespaces no.
    "clone": (((0, _THREAD, _THREAD | _CLONE_NAMESPACES),),),
    # Only its own limits, and only to read them.
    "prlimit64": (((0, 0, 0), (2, 0, 0)),),
    # Signals to itself, as raise() and abort() send them. SIGKILL and SIGSTOP are left out so that seeing
    # one always means somebody else sent it.
    "kill": tuple(((0, OWN_PID, 0), (1, n, _LOW_32)) for n in _SELF_SIGNALS),
    "tgkill": tuple(((0, OWN_PID, 0), (2, n, _LOW_32)) for n in _SELF_SIGNALS),
    # F_DUPFD, F_GETFD, F_SETFD, F_GETFL, F_SETFL, F_DUPFD_CLOEXEC, F_GETPIPE_SZ: no locks, leases, owners.
    "fcntl": _one_of(1, (0, 1, 2, 3, 4, 1030, 1032)),
    # TCGETS, TIOCGWINSZ, FIONREAD, FIONBIO, FIONCLEX, FIOCLEX.
    "ioctl": _one_of(1, (0x5401, 0x5413, 0x541B, 0x5421, 0x5450, 0x5451)),
    # PR_SET_NAME, PR_GET_NAME.
    "prctl": _one_of(0, (15, 16)),
    # A pair of connected stream sockets, as an asyncio loop needs; no other way to get a socket.
    "socketpair": tuple(
        ((0, _AF_UNIX, _LOW_32), (1, _SOCK_STREAM | flags, _LOW_32))
        for flags in (0, 0o4000, 0o2000000, 0o2004000)
    ),
    # Without a destination address, and never with ancillary data (sendmsg stays refused).
    "sendto": (((4, 0, 0),),),
}
"""System calls a confined process may make. All others fail with EPERM."""

REFUSED_AS_MISSING: Final = ("clone3",)
"""Answered with ENOSYS, which makes the C library fall back to a call that the filter can look into."""

REFUSED_ERRNO: Final = errno.EPERM

# ---------------------------------------------------------------------------------------------- resources

ADDRESS_SPACE_OVERHEAD_BYTES: Final = 384 * MIB
"""Room for mappings that are no use of memory: shared libraries, guard areas. It also bounds what a script
can hold in shared mappings, which the limit on private memory does not count."""

THREAD_STACK_BYTES: Final = 4 * MIB
CPU_BACKSTOP_S: Final = 2
"""The kernel's own CPU limit stands this far above the one the supervisor enforces to the millisecond."""


def resource_limits(cpu_s: float, memory_bytes: int, threads: int | None) -> dict[int, int]:
    """Return the rlimits of a confined process, soft = hard.

    Args:
        cpu_s: CPU seconds granted.
        memory_bytes: private memory granted.
        threads: most threads at once, or None where the kernel could not count this process alone.
    """
    limits = {
        resource.RLIMIT_AS: memory_bytes + ADDRESS_SPACE_OVERHEAD_BYTES,
        resource.RLIMIT_DATA: memory_bytes,
        resource.RLIMIT_CPU: math.ceil(cpu_s) + CPU_BACKSTOP_S,
        resource.RLIMIT_FSIZE: 0,
        resource.RLIMIT_NOFILE: 64,
        resource.RLIMIT_CORE: 0,
        resource.RLIMIT_STACK: 8 * MIB,
        resource.RLIMIT_MEMLOCK: 0,
    }
    if hasattr(resource, "RLIMIT_MSGQUEUE"):
        limits[resource.RLIMIT_MSGQUEUE] = 0
    if threads is not None:
        limits[resource.RLIMIT_NPROC] = threads + 1
    return limits


# ------------------------------------------------------------------------------------------------- files

STDLIB_EXCLUDED: Final = frozenset(
    {"site-packages", "dist-packages", "test", "idlelib", "ensurepip", "turtledemo", "lib2to3"}
)
"""Entries of the standard library's directory that a confined process cannot read."""

SHARED_LIBRARY_DIRECTORIES: Final = (
    "/lib64",
    "/usr/lib64",
    "/lib/x86_64-linux-gnu",
    "/usr/lib/x86_64-linux-gnu",
    "/lib/aarch64-linux-gnu",
    "/usr/lib/aarch64-linux-gnu",
)

WRITABLE_DEVICES: Final = ("/dev/null",)
READABLE_DEVICES: Final = ("/dev/urandom",)

ALLOWED_PACKAGES: Final = {"numpy": ("numpy", "numpy.libs"), "yaml": ("yaml",)}
"""Third-party packages a script may import, with the directories each needs. Both come with ROS 2 itself."""

# ------------------------------------------------------------------------------------------- environment

ENVIRONMENT: Final = {
    "PYTHONHASHSEED": "0",  # sets and dicts of strings iterate in the same order in every run
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "MALLOC_ARENA_MAX": "1",  # 64 MiB of address space per thread otherwise
    "TZ": "UTC0",
}
"""All of the zygote's environment, and so of every confined process."""

# ------------------------------------------------------------------------------------------------ own uid

BOX_UID_BASE: Final = 0x7000_0000
"""First of the ids that systemd's allocation table leaves unused; the slot's process id is added."""
BOX_UID_BASE_MAPPED: Final = 60706
BOX_UID_COUNT_MAPPED: Final = 478
"""Unused range within 16 bits, for containers that map no more ids."""

# ------------------------------------------------------------------------------------------- supervision

FRAME_MAX_BYTES: Final = 65_536
"""Largest frame body accepted from a confined process."""
FRAMES_MAX: Final = 500_000
CHANNEL_MAX_BYTES: Final = 128 * MIB
"""What one run may send; a busy loop that publishes for a minute of virtual time stays far below."""
STREAM_HEAD_BYTES: Final = 64 * 1024
STREAM_TAIL_BYTES: Final = 64 * 1024
IDLE_LIMIT_NS: Final = 3_000_000_000
"""A process whose every thread sleeps in the kernel that long in all, while it owes a frame, is stalled.

The shim never sleeps in real time. A thread that an overloaded host keeps waiting is not asleep but ready."""
DRAIN_LIMIT_NS: Final = 50_000_000
