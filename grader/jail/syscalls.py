"""The system calls a confined process may make: the table, the seccomp filter built from it, and its loading.

Every call that `SYSCALLS` does not name fails. The filters are shipped as bytes, so that grading needs no
libseccomp and compiles nothing at its start. After a change of the table run ``python -m grader.jail.syscalls`` to
build them again (that needs `pyseccomp`); a test rebuilds and compares them.

The zygote imports this module: standard library only, at import time.
"""

import ctypes
import errno
import os
import struct
from typing import Final

from .libc import MACHINE, NR_SECCOMP, SUPPORTED_MACHINES, syscall

FILTER_DIRECTORY: Final = os.path.join(os.path.dirname(os.path.abspath(__file__)), "filters")
_SECCOMP_SET_MODE_FILTER: Final = 1
_INSTRUCTION_BYTES: Final = 8

# ---------------------------------------------------------------------------------------------- the table

OWN_PID: Final = 0x5A17C0DE
"""Placeholder for the process's own id in a shipped filter; `bind_to_process` replaces it."""


Arg = tuple[int, int, int]
"""A condition (index, value, mask) on one argument: ``argument[index] & mask == value``; mask 0: all bits."""

Rule = tuple[Arg, ...]
"""Conditions that must all hold."""

ANY: Final[tuple[Rule, ...]] = ((),)

_LOW_32: Final = 0xFFFF_FFFF  # the kernel ignores the upper half of these arguments, so the filter must too
_CLONE_VM, _CLONE_SIGHAND, _CLONE_THREAD = 0x100, 0x800, 0x10000
_CLONE_NAMESPACES: Final = 0x7E020080
_CLONE_VFORK: Final = 0x4000
_THREAD: Final = _CLONE_VM | _CLONE_SIGHAND | _CLONE_THREAD
_FUTEX_WAIT, _FUTEX_WAIT_BITSET, _FUTEX_PRIVATE, _FUTEX_CLOCK = 0, 9, 128, 256
_AF_UNIX, _SOCK_STREAM, _SOL_SOCKET, _MSG_OOB = 1, 1, 1, 1
# INT QUIT ILL ABRT BUS FPE USR1 SEGV USR2 ALRM TERM: never KILL or STOP.
_SELF_SIGNALS: Final = (2, 3, 4, 6, 7, 8, 10, 11, 12, 14, 15)


def _one_of(index: int, values: tuple[int, ...]) -> tuple[Rule, ...]:
    return tuple(((index, value, _LOW_32),) for value in values)


O_DIRECT: Final = {"x86_64": 0o40000, "aarch64": 0o200000}
_O_DIRECT: Final = -1
"""Placeholder for the bit of that flag in the mask of a condition; `table` replaces it."""

_FILES = ("read readv pread64 preadv write writev pwrite64 lseek close fstat newfstatat statx "
          "stat lstat access faccessat faccessat2 readlink readlinkat getdents64 getcwd chdir dup dup2 dup3 "
          "pipe pipe2")  # fmt: skip
_MEMORY = "mmap mprotect munmap mremap brk"
_THREADS = ("rseq set_robust_list set_tid_address exit exit_group rt_sigaction rt_sigprocmask "
            "rt_sigreturn rt_sigpending sigaltstack restart_syscall sched_yield sched_getaffinity "
            "getcpu")  # fmt: skip
_TIME = "gettimeofday time times nanosleep"
_CLOCKS = "clock_gettime clock_getres clock_nanosleep"
_WAITING = ("poll ppoll select pselect6 epoll_create1 epoll_create epoll_ctl epoll_wait epoll_pwait "
            "epoll_pwait2 eventfd2 pause")  # fmt: skip
_IDENTITY = ("getpid getppid gettid getuid geteuid getgid getegid getresuid getresgid getgroups getpgid "
             "getpgrp getsid uname sysinfo getrusage getrlimit getrandom")  # fmt: skip
_SOCKETS = "recvfrom getsockname getpeername shutdown"

# Left out because a thread waits in them without using CPU time, as if the host were slow: fsync (for a disk; the
# shim answers for the script's own files), membarrier (for all other processors).
SYSCALLS: Final[dict[str, tuple[Rule, ...]]] = {
    **dict.fromkeys(" ".join((_FILES, _MEMORY, _THREADS, _TIME, _WAITING, _IDENTITY, _SOCKETS)).split(), ANY),
    # The host's clocks and its own CPU time. A negative number is the CPU time of any process, or a device.
    **dict.fromkeys(_CLOCKS.split(), (((0, 0, _LOW_32 & ~0xF),),)),
    # Between its own threads; of those that other processes share, only waiting, as for the end of a thread.
    # Whoever wakes waiters in a page of a library that two runs have mapped could talk to the other one.
    "futex": (
        ((1, _FUTEX_PRIVATE, _FUTEX_PRIVATE),),
        *(((1, operation, _LOW_32 & ~_FUTEX_CLOCK),) for operation in (_FUTEX_WAIT, _FUTEX_WAIT_BITSET)),
    ),
    # Threads yes, processes and namespaces no. Not VFORK: whoever waits for the end of its child seems to wait for
    # a disk, and adds to the host's load.
    "clone": (((0, _THREAD, _THREAD | _CLONE_NAMESPACES | _CLONE_VFORK),),),
    # Only its own limits, and only to read them.
    "prlimit64": (((0, 0, 0), (2, 0, 0)),),
    # Signals to itself, as raise() and abort() send them. Not SIGKILL and SIGSTOP: if a run ends by one of
    # them, the kernel or the grader has sent it.
    "kill": tuple(((0, OWN_PID, 0), (1, n, _LOW_32)) for n in _SELF_SIGNALS),
    "tgkill": tuple(((0, OWN_PID, 0), (2, n, _LOW_32)) for n in _SELF_SIGNALS),
    # Not past the page cache: whoever reads a disk without end makes the host look slow.
    "open": (((1, 0, _O_DIRECT),),),
    "openat": (((2, 0, _O_DIRECT),),),
    # F_DUPFD, F_GETFD, F_SETFD, F_GETFL, F_SETFL, F_DUPFD_CLOEXEC, F_GETPIPE_SZ: no locks, leases, owners.
    "fcntl": (*_one_of(1, (0, 1, 2, 3, 1030, 1032)), ((1, 4, _LOW_32), (2, 0, _O_DIRECT))),
    # TCGETS, TIOCGWINSZ, FIONREAD, FIONBIO, FIONCLEX, FIOCLEX.
    "ioctl": _one_of(1, (0x5401, 0x5413, 0x541B, 0x5421, 0x5450, 0x5451)),
    # What allocators and numpy ask: NORMAL to DONTNEED, FREE, (NO)HUGEPAGE, (DO)DUMP, WIPEONFORK, KEEPONFORK. Not
    # PAGEOUT and COLD: a page that was put out has to be waited for.
    "madvise": _one_of(2, (0, 1, 2, 3, 4, 8, 14, 15, 16, 17, 18, 19)),
    # PR_SET_NAME, PR_GET_NAME.
    "prctl": _one_of(0, (15, 16)),
    # A pair of connected stream sockets, as an asyncio loop needs; no other way to get a socket.
    "socketpair": tuple(
        ((0, _AF_UNIX, _LOW_32), (1, _SOCK_STREAM | flags, _LOW_32))
        for flags in (0, 0o4000, 0o2000000, 0o2004000)
    ),
    # Only without a destination address, and nothing urgent (MSG_OOB), which the other end reads out of turn.
    # sendmsg, which can carry ancillary data, stays refused.
    "sendto": (((4, 0, 0), (3, 0, _MSG_OOB)),),
    # REUSEADDR, TYPE, ERROR, SNDBUF, RCVBUF, PROTOCOL, DOMAIN: what Python asks of a pair. Not who is at the other
    # end of the channel: PEERPIDFD gives a descriptor of the grader's process.
    "getsockopt": tuple(((1, _SOL_SOCKET, _LOW_32), (2, n, _LOW_32)) for n in (2, 3, 4, 7, 8, 38, 39)),
}
"""System calls a confined process may make. All others fail with EPERM."""


def table(machine: str) -> dict[str, tuple[Rule, ...]]:
    """Return `SYSCALLS` as it is on `machine`, whose flags have numbers of their own."""
    bit = O_DIRECT[machine]

    def bound(rule: Rule) -> Rule:
        return tuple((index, value, bit if mask == _O_DIRECT else mask) for index, value, mask in rule)

    return {name: tuple(map(bound, rules)) for name, rules in SYSCALLS.items()}


REFUSED_AS_MISSING: Final = ("clone3",)
"""Answered with ENOSYS: the C library then falls back to `clone`, whose flags the filter can check. Those of
`clone3` lie in memory, which no filter can read."""

REFUSED_ERRNO: Final = errno.EPERM

# ----------------------------------------------------------------------------------------------- loading

_OWN_PID_BYTES: Final = struct.pack("<I", OWN_PID)


class _Program(ctypes.Structure):
    _fields_ = (("length", ctypes.c_ushort), ("instructions", ctypes.c_char_p))


def read_filter(machine: str = MACHINE, directory: str = FILTER_DIRECTORY) -> bytes:
    """Return the filter shipped for `machine`. Raises OSError: there is none for this architecture."""
    with open(filter_path(machine, directory), "rb") as file:
        return file.read()


def filter_path(machine: str = MACHINE, directory: str = FILTER_DIRECTORY) -> str:
    """Return where the filter for `machine` is, or would be."""
    return os.path.join(directory, f"{machine}.bpf")


def bind_to_process(program: bytes, pid: int) -> bytes:
    """Return `program` with the placeholder of the process's own id replaced by `pid`.

    Raises ValueError: the program has no placeholder, so it was not built from this table.
    """
    if _OWN_PID_BYTES not in program:
        raise ValueError("the seccomp filter was not built from this table of system calls")
    return program.replace(_OWN_PID_BYTES, struct.pack("<I", pid))


def load(program: bytes) -> None:
    """Confine this thread, and all that it starts, to `program`. It cannot be undone, and needs no_new_privs.

    Raises OSError: the kernel refused.
    """
    argument = _Program(len(program) // _INSTRUCTION_BYTES, program)
    syscall("seccomp", NR_SECCOMP[MACHINE], _SECCOMP_SET_MODE_FILTER, 0, ctypes.byref(argument))


# ---------------------------------------------------------------------------------------------- building


def build_filter(machine: str) -> bytes:
    """Return the BPF program of the table for `machine` (``x86_64`` or ``aarch64``).

    Raises OSError: libseccomp refused a rule.
    """
    import tempfile

    import pyseccomp  # type: ignore[import-untyped]

    arch = {"x86_64": pyseccomp.Arch.X86_64, "aarch64": pyseccomp.Arch.AARCH64}[machine]
    program = pyseccomp.SyscallFilter(pyseccomp.ERRNO(REFUSED_ERRNO))
    program.set_attr(pyseccomp.Attr.ACT_BADARCH, pyseccomp.KILL_PROCESS)
    if arch != pyseccomp.system_arch():
        program.add_arch(arch)
        program.remove_arch(pyseccomp.system_arch())
    for name, rules in table(machine).items():
        if pyseccomp.resolve_syscall(arch, name) < 0:
            continue  # an old call, which newer architectures do not have
        for rule in rules:
            conditions = (
                pyseccomp.Arg(index, pyseccomp.MASKED_EQ, mask, value)
                if mask
                else pyseccomp.Arg(index, pyseccomp.EQ, value)
                for index, value, mask in rule
            )
            program.add_rule(pyseccomp.ALLOW, name, *conditions)
    for name in REFUSED_AS_MISSING:
        program.add_rule(pyseccomp.ERRNO(errno.ENOSYS), name)
    with tempfile.TemporaryFile() as file:
        program.export_bpf(file)
        file.seek(0)
        return file.read()


def main() -> None:
    """Write the filter of every supported architecture."""
    os.makedirs(FILTER_DIRECTORY, exist_ok=True)
    for machine in SUPPORTED_MACHINES:
        with open(filter_path(machine), "wb") as file:
            file.write(build_filter(machine))


if __name__ == "__main__":
    main()
