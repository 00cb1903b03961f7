"""The table of system calls and the other bounds as data, and the filters shipped for the table."""

import resource
import struct

import pytest

from grader.jail import bounds, syscalls
from grader.jail.libc import SUPPORTED_MACHINES

UNCONDITIONAL = (
    "read readv pread64 preadv write writev pwrite64 lseek close fstat newfstatat statx stat "
    "lstat access faccessat faccessat2 "
    " readlink readlinkat getdents64 getcwd chdir dup dup2 dup3 pipe pipe2 "
    "mmap mprotect munmap mremap brk rseq set_robust_list set_tid_address exit exit_group "
    "rt_sigaction rt_sigprocmask rt_sigreturn rt_sigpending sigaltstack restart_syscall sched_yield "
    "sched_getaffinity getcpu gettimeofday time times nanosleep "
    "poll ppoll select pselect6 epoll_create1 epoll_create epoll_ctl epoll_wait epoll_pwait "
    "epoll_pwait2 eventfd2 pause getpid getppid gettid getuid geteuid getgid getegid getresuid getresgid "
    "getgroups getpgid getpgrp getsid uname sysinfo getrusage getrlimit getrandom recvfrom getsockname "
    "getpeername shutdown"
)
CONDITIONAL = {
    "clock_getres",
    "clock_gettime",
    "clock_nanosleep",
    "clone",
    "futex",
    "prlimit64",
    "kill",
    "tgkill",
    "open",
    "openat",
    "fcntl",
    "ioctl",
    "madvise",
    "prctl",
    "socketpair",
    "sendto",
    "getsockopt",
}


def test_exactly_these_calls_are_allowed() -> None:
    assert {name for name, rules in syscalls.SYSCALLS.items() if rules == syscalls.ANY} == set(
        UNCONDITIONAL.split()
    )
    assert {name for name, rules in syscalls.SYSCALLS.items() if rules != syscalls.ANY} == CONDITIONAL


def test_every_rule_of_a_conditional_call_has_a_condition() -> None:
    assert all(rule for name in CONDITIONAL for rule in syscalls.SYSCALLS[name])


@pytest.mark.parametrize("machine", SUPPORTED_MACHINES)
def test_the_shipped_filter_is_built_from_the_table(machine: str) -> None:
    pytest.importorskip("pyseccomp")
    assert syscalls.read_filter(machine) == syscalls.build_filter(machine)


@pytest.mark.parametrize("machine", SUPPORTED_MACHINES)
def test_placeholder_appears_only_as_a_compared_value(machine: str) -> None:
    program = syscalls.read_filter(machine)
    instructions = [struct.unpack_from("<HBBI", program, at) for at in range(0, len(program), 8)]
    jump_if_equal = 0x15
    with_placeholder = [code for code, _, _, value in instructions if value == syscalls.OWN_PID]
    assert with_placeholder
    assert set(with_placeholder) == {jump_if_equal}
    assert program.count(struct.pack("<I", syscalls.OWN_PID)) == len(with_placeholder)


def test_binding_leaves_no_placeholder() -> None:
    program = syscalls.bind_to_process(syscalls.read_filter("x86_64"), 4321)
    assert struct.pack("<I", syscalls.OWN_PID) not in program
    assert struct.pack("<I", 4321) in program


def test_a_foreign_filter_is_not_taken() -> None:
    with pytest.raises(ValueError, match="was not built from this table"):
        syscalls.bind_to_process(bytes(64), 1)


def test_resource_limits() -> None:
    limits = bounds.resource_limits(0.5, 1000, 3)
    assert limits[resource.RLIMIT_DATA] == 1000
    assert limits[resource.RLIMIT_CPU] == bounds.CPU_BACKSTOP
    assert limits[resource.RLIMIT_NPROC] == 4
    assert limits[resource.RLIMIT_FSIZE] == limits[resource.RLIMIT_CORE] == 0
    assert resource.RLIMIT_NPROC not in bounds.resource_limits(0.5, 1000, None)
