"""What a script can learn about its host (randomness, process ids, processors): the same in each run."""

from __future__ import annotations

import _random
import errno
import os
import sys

from rclpy._kernel import kernel
from rclpy._patches.time import process_time
from rclpy._storage.entries import HOME, UID, USER, WORK

TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import ModuleType
    from typing import Any

PID = 4242
CPUS = 4
HOST = "ubuntu"
PYTHON = "/usr/bin/python3"
TERMINAL = (80, 24)
RESIDENT_KIB = 50_000
"""About what an interpreter with rclpy takes."""
DEEPEST = 30_000
"""Calls within calls that an interpreter of Humble survives at most, whatever limit was set: its stack is 8 MiB.
Python 3.11 needs no stack for them and would go on until the memory is used up, which no two runs do alike."""
NO_DISPLAY = "no display name and no $DISPLAY environment variable"
_ENVIRONMENT = {
    name.encode(): value.encode()
    for name, value in (
        *(("HOME", HOME), ("LOGNAME", USER), ("PWD", WORK), ("USER", USER)),
        *(("ROS_DISTRO", "humble"), ("ROS_PYTHON_VERSION", "3"), ("ROS_VERSION", "2")),
    )
}
UNAME = os.uname_result(("Linux", HOST, "5.15.0-91-generic", "#101-Ubuntu SMP", "x86_64"))
"""Ubuntu 22.04, on which Humble runs."""

_entropy = _random.Random(0)
_kill = os.kill
_get_terminal_size = os.get_terminal_size
_set_recursion_limit = sys.setrecursionlimit


def set_environment() -> None:
    """Set the environment variables that a login and ROS's setup file set.

    The C library's copy is left as it is: only a new process would get it.
    """
    names: Any = os.environ
    names._data.update(_ENVIRONMENT)
    sys.executable = PYTHON


def seed_entropy(seed: int) -> None:
    """Begin the stream that stands in for the operating system's randomness."""
    _entropy.seed(seed)


def urandom(size: int, /) -> bytes:
    """Return `size` bytes of the seeded stream."""
    if size < 0:
        raise ValueError("negative argument not allowed")
    return _entropy.getrandbits(8 * size).to_bytes(size, "little") if size else b""


def getrandom(size: int, flags: int = 0) -> bytes:
    return urandom(size)


def getpid() -> int:
    return PID


def getppid() -> int:
    return PID - 1


def getpgrp() -> int:
    """The script leads its group and, as far as it can tell, its session."""
    return PID


def getpgid(pid: int, /) -> int:
    if pid not in (PID, 0):
        raise ProcessLookupError(errno.ESRCH, os.strerror(errno.ESRCH))
    return PID


def getuid() -> int:
    return UID


def getgroups() -> list[int]:
    return [UID]


def getlogin() -> str:
    return USER


def uname() -> os.uname_result:
    return UNAME


def get_terminal_size(fd: int = 1, /) -> os.terminal_size:
    """Answer for the script's own streams as for a terminal of the usual size, which they are not."""
    return os.terminal_size(TERMINAL) if fd in (0, 1, 2) else _get_terminal_size(fd)


def cpu_count() -> int:
    return CPUS


def sched_getaffinity(pid: int, /) -> set[int]:
    return set(range(CPUS))


def times() -> os.times_result:
    return os.times_result((process_time(), 0.0, 0.0, 0.0, kernel.now_ns / 1e9))


def getloadavg() -> tuple[float, float, float]:
    return (0.0, 0.0, 0.0)


def kill(pid: int, number: int, /) -> None:
    """Send the script itself a virtual signal; the sandbox refuses any other target."""
    if pid not in (PID, 0):
        _kill(pid, number)
    elif number:
        import signal

        signal.raise_signal(number)


def setrecursionlimit(limit: int, /) -> None:
    """Set the limit, at most to what a stack holds."""
    _set_recursion_limit(DEEPEST if isinstance(limit, int) and DEEPEST < limit < 2**31 else limit)


REPLACED: dict[str, object] = {
    "urandom": urandom,
    "getrandom": getrandom,
    "getpid": getpid,
    "getppid": getppid,
    "getpgrp": getpgrp,
    "getsid": getpgid,
    **dict.fromkeys(("getuid", "geteuid", "getgid", "getegid"), getuid),
    "getgroups": getgroups,
    "getlogin": getlogin,
    "get_terminal_size": get_terminal_size,
    "uname": uname,
    "cpu_count": cpu_count,
    "getloadavg": getloadavg,
    "process_cpu_count": cpu_count,
    "sched_getaffinity": sched_getaffinity,
    "times": times,
    "kill": kill,
}
"""What replaces the functions of `os`, by name."""

REPLACED_SYS: dict[str, object] = {"setrecursionlimit": setrecursionlimit}


def patch_random(random: ModuleType) -> None:
    """Seed the hidden generator, and every one that is created without a seed, from the seeded stream."""
    module: Any = random
    seed = module.Random.seed

    def seeded(self: Any, a: Any = None, version: int = 2) -> None:
        seed(self, _entropy.getrandbits(256) if a is None else a, version)

    seeded.__name__ = "seed"
    seeded.__qualname__ = "Random.seed"
    seeded.__doc__ = seed.__doc__
    module.Random.seed = seeded
    module._urandom = urandom
    module._inst.seed()
    module.seed = module._inst.seed


def patch_resource(resource: ModuleType) -> None:
    """Make `getrusage` return what `times` does, and always the same memory."""
    module: Any = resource
    real = module.getrusage

    def getrusage(who: int, /) -> Any:
        real(who)  # raises what the real call raises for an unknown `who`
        return module.struct_rusage((process_time(), 0.0, RESIDENT_KIB, *[0] * 13))

    module.getrusage = getrusage


def patch_uuid(uuid: ModuleType) -> None:
    """Make `uuid1` depend on the virtual clock only."""
    module: Any = uuid
    module._generate_time_safe = module._UuidCreate = None
    module._node = 0x0242AC110002


def patch_socket(socket: ModuleType) -> None:
    """Make `gethostname` return the name that `os.uname` gives."""
    module: Any = socket
    module.gethostname = lambda: HOST


def patch_tkinter(tkinter: ModuleType) -> None:
    """Make a window fail as it does without a screen, whether or not this host has Tcl."""
    module: Any = tkinter

    def create(*args: Any, **options: Any) -> None:
        raise module.TclError(NO_DISPLAY)

    module.create = create


def patch_dbm(dbm: ModuleType) -> None:
    """Make `shelve` use the database that is written in Python, because that one goes through `open`."""
    module: Any = dbm
    module._names = ["dbm.dumb"]


def patch_curses(curses: ModuleType) -> None:
    """Make a full-screen program fail in the same way, whatever terminals this host knows."""
    module: Any = curses

    def setupterm(*args: Any, **options: Any) -> None:
        raise module.error("setupterm: could not find terminal")

    module.setupterm = setupterm
