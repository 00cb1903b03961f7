"""The shipped filters, interpreted instruction by instruction as the kernel would, for every architecture."""

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.jail import syscalls

pyseccomp = pytest.importorskip("pyseccomp")

ALLOW, EPERM, ENOSYS, KILL = 0x7FFF0000, 0x00050001, 0x00050026, 0x80000000
AUDIT = {"x86_64": 0xC000003E, "aarch64": 0xC00000B7}
ARCH = {"x86_64": pyseccomp.Arch.X86_64, "aarch64": pyseccomp.Arch.AARCH64}
PID = 4321
WORD = st.one_of(
    st.integers(0, 2**64 - 1), st.integers(0, 64), st.sampled_from([PID, PID | 1 << 32, syscalls.OWN_PID])
)
MACHINES = pytest.mark.parametrize("machine", list(AUDIT))


def load(machine: str) -> list[tuple[int, int, int, int]]:
    program = syscalls.bind_to_process(syscalls.read_filter(machine), PID)
    return [struct.unpack_from("<HBBI", program, at) for at in range(0, len(program), 8)]


PROGRAMS = {machine: load(machine) for machine in AUDIT}


def verdict(machine: str, number: int, *arguments: int, audit: int | None = None) -> int:
    """What the filter answers: a classic BPF machine with one register over the call's 64 bytes."""
    padded = [*arguments, 0, 0, 0, 0, 0, 0][:6]
    data = struct.pack("<IIQ6Q", number & 0xFFFFFFFF, audit or AUDIT[machine], 0, *padded)
    program, at, register = PROGRAMS[machine], 0, 0
    jumps = {0x15: int.__eq__, 0x25: int.__gt__, 0x35: int.__ge__, 0x45: lambda a, b: bool(a & b)}
    while True:
        code, if_true, if_false, value = program[at]
        at += 1
        if code == 0x20:
            (register,) = struct.unpack_from("<I", data, value)
        elif code == 0x54:
            register &= value
        elif code == 0x05:
            at += value
        elif code == 0x06:
            return value
        else:
            at += if_true if jumps[code](register, value) else if_false


def number_of(machine: str, name: str) -> int:
    return int(pyseccomp.resolve_syscall(ARCH[machine], name))


@MACHINES
def test_every_call_number_gets_what_the_policy_says(machine: str) -> None:
    allowed = {number_of(machine, name) for name, rules in syscalls.SYSCALLS.items() if rules == syscalls.ANY}
    missing = {number_of(machine, name) for name in syscalls.REFUSED_AS_MISSING}
    refusing = (2**64 - 1,) * 6
    allowed.add(number_of(machine, "futex"))  # these have the bit of those that no other process shares
    for number in range(1024):
        expected = ALLOW if number in allowed else ENOSYS if number in missing else EPERM
        assert verdict(machine, number, *refusing) == expected, number


@MACHINES
def test_calls_of_another_architecture_kill(machine: str) -> None:
    for audit in (0x40000003, 0x40000028, *set(AUDIT.values()) - {AUDIT[machine]}):
        assert verdict(machine, number_of(machine, "read"), audit=audit) == KILL


def test_calls_of_the_x32_table_kill() -> None:
    assert {verdict("x86_64", 0x4000_0000 | number) for number in range(600)} == {KILL}


@MACHINES
@given(arguments=st.lists(WORD, min_size=6, max_size=6))
def test_conditional_calls_obey_their_conditions(machine: str, arguments: list[int]) -> None:
    for name, rules in syscalls.table(machine).items():
        number = number_of(machine, name)
        if number < 0 or rules == syscalls.ANY:
            continue
        holds = any(all(_holds(part, arguments) for part in rule) for rule in rules)
        assert (verdict(machine, number, *arguments) == ALLOW) == holds, name


def _holds(part: syscalls.Arg, arguments: list[int]) -> bool:
    index, value, mask = part
    wanted = PID if value == syscalls.OWN_PID else value
    return (arguments[index] & mask if mask else arguments[index]) == wanted


THREAD = 0x10F00  # CLONE_VM | CLONE_FS | CLONE_FILES | CLONE_SIGHAND | CLONE_THREAD


@MACHINES
@pytest.mark.parametrize(
    ("name", "arguments", "allowed"),
    [
        ("clone", (THREAD,), True),
        ("clone", (17,), False),
        ("clone", (THREAD | 0x1000_0000,), False),
        ("clone", (THREAD | 0x4000_0000,), False),
        ("futex", (1234, 1 | 128, 1), True),
        ("futex", (1234, 0 | 256, 1), True),  # as glibc waits for the end of a thread
        ("futex", (1234, 9, 1), True),
        ("futex", (1234, 1, 1), False),
        ("futex", (1234, 3, 1), False),
        ("prlimit64", (0, 7, 0, 1234), True),
        ("prlimit64", (0, 7, 1234, 0), False),
        ("prlimit64", (1, 7, 0, 1234), False),
        ("kill", (PID, 15), True),
        ("kill", (PID, 9), False),
        ("kill", (PID, 19), False),
        ("kill", (0, 15), False),
        ("kill", (2**64 - 1, 15), False),
        ("tgkill", (PID, 77, 6), True),
        ("tgkill", (1, 1, 6), False),
        ("ioctl", (1, 0x5412), False),  # TIOCSTI
        ("ioctl", (1, 0x5412 | 1 << 32), False),
        ("ioctl", (1, 0x5401 | 1 << 32), True),  # the kernel looks at the low half only
        ("prctl", (15,), True),
        ("prctl", (4, 1), False),
        ("socketpair", (1, 1), True),
        ("socketpair", (1, 2), False),
        ("socketpair", (2, 1), False),
        ("sendto", (3, 1234, 5, 0, 0, 0), True),
        ("sendto", (3, 1234, 5, 0, 99, 16), False),
        ("openat", (0xFFFFFF9C, 1234, 0o100), True),
        ("fcntl", (3, 4, 0o4000), True),
        ("fcntl", (3, 8, 1), False),
        ("fcntl", (3, 1031, 1 << 20), False),
    ],
)
def test_conditions_in_plain_words(
    machine: str, name: str, arguments: tuple[int, ...], allowed: bool
) -> None:
    assert (verdict(machine, number_of(machine, name), *arguments) == ALLOW) is allowed


@MACHINES
def test_no_file_is_read_past_the_page_cache(machine: str) -> None:
    direct = syscalls.O_DIRECT[machine]
    calls = (("open", (1, direct)), ("openat", (3, 1, direct | 1)), ("fcntl", (3, 4, direct | 0o4000)))
    assert all(
        verdict(machine, number_of(machine, name), *arguments) == EPERM
        for name, arguments in calls
        if number_of(machine, name) >= 0
    )
    (other,) = set(syscalls.O_DIRECT.values()) - {direct}  # the number of another flag here
    assert verdict(machine, number_of(machine, "openat"), 3, 1, other) == ALLOW
