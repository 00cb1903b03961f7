"""Thin, typed wrappers of the C library for calls that Python does not offer.

Standard library only: imported by the zygote.
"""

import ctypes
import os
from typing import Final

_libc = ctypes.CDLL(None, use_errno=True)
_Usage = ctypes.c_long * 18  # struct rusage

MACHINE: Final = os.uname().machine
SUPPORTED_MACHINES: Final = ("x86_64", "aarch64")

# Same numbers on every architecture that uses the generic table since Linux 5.1.
NR_MOUNT_SETATTR: Final = 442
NR_LANDLOCK_CREATE_RULESET: Final = 444
NR_LANDLOCK_ADD_RULE: Final = 445
NR_LANDLOCK_RESTRICT_SELF: Final = 446
NR_SECCOMP: Final = {"x86_64": 317, "aarch64": 277}
NR_PIVOT_ROOT: Final = {"x86_64": 155, "aarch64": 41}
NR_CAPSET: Final = {"x86_64": 126, "aarch64": 91}

PR_SET_PDEATHSIG: Final = 1
PR_SET_DUMPABLE: Final = 4
PR_SET_KEEPCAPS: Final = 8
PR_SET_NO_NEW_PRIVS: Final = 38

CLONE_NEWNS: Final = 0x00020000
CLONE_NEWCGROUP: Final = 0x02000000
CLONE_NEWUTS: Final = 0x04000000
CLONE_NEWIPC: Final = 0x08000000
CLONE_NEWUSER: Final = 0x10000000
CLONE_NEWPID: Final = 0x20000000
CLONE_NEWNET: Final = 0x40000000

ADDR_NO_RANDOMIZE: Final = 0x0040000
PERSONALITY_QUERY: Final = 0xFFFFFFFF

_CAPABILITY_VERSION_3: Final = 0x20080522
CAP_DAC_READ_SEARCH: Final = 2


def _checked(result: int, call: str) -> int:
    if result < 0:
        number = ctypes.get_errno()
        raise OSError(number, f"{call}: {os.strerror(number)}")
    return result


def syscall(call: str, number: int, *arguments: object) -> int:
    """Make system call `number` of this architecture.

    `call` is its name, for the error message. Arguments are bytes, None, ctypes objects, or ints, passed as C
    longs.

    Raises OSError: the kernel refused, with its error number.
    """
    converted = [ctypes.c_long(a) if isinstance(a, int) else a for a in arguments]
    return _checked(int(_libc.syscall(ctypes.c_long(number), *converted)), call)


def prctl(option: int, *arguments: int) -> int:
    """Change a property of this process; missing arguments are zero."""
    padded = [ctypes.c_ulong(a) for a in (*arguments, 0, 0, 0, 0)[:4]]
    return _checked(int(_libc.prctl(ctypes.c_int(option), *padded)), "prctl")


def present_core() -> int:
    """Return the number of the core that this thread runs on."""
    return _checked(int(_libc.sched_getcpu()), "sched_getcpu")


def unshare(flags: int) -> None:
    """Leave the namespaces named by `flags` (CLONE_NEW*)."""
    _checked(int(_libc.unshare(ctypes.c_int(flags))), "unshare")


def mount(source: str, target: str, kind: str, flags: int, data: str = "") -> None:
    """Attach a file system at `target`."""
    result = _libc.mount(
        os.fsencode(source), os.fsencode(target), kind.encode(), ctypes.c_ulong(flags), data.encode() or None
    )
    _checked(int(result), f"mount {target}")


def umount_lazily(target: str) -> None:
    """Detach the mount at `target`; it goes away when its last user is gone."""
    mnt_detach = 2
    _checked(int(_libc.umount2(os.fsencode(target), ctypes.c_int(mnt_detach))), f"umount {target}")


def personality(persona: int) -> int:
    """Set the calling thread's execution domain (`PERSONALITY_QUERY`: only ask); return the former one."""
    return _checked(int(_libc.personality(ctypes.c_ulong(persona))), "personality")


def set_capabilities(mask: int) -> None:
    """Make `mask` (bits 0-31) this thread's permitted and effective set and empty the inheritable one."""
    header = (ctypes.c_uint32 * 2)(_CAPABILITY_VERSION_3, 0)
    data = (ctypes.c_uint32 * 6)(mask, mask, 0, 0, 0, 0)
    syscall("capset", NR_CAPSET[MACHINE], ctypes.byref(header), ctypes.byref(data))


def wait(pid: int) -> tuple[int, int, int]:
    """Wait for child `pid` to end; return its wait status, processor time in ns and `ru_maxrss`.

    Not `os.wait4`: from Python 3.12 on, each call leaves a new string in the interpreter's cache of attributes
    (`_PyImport_GetModuleAttrString` of ``struct_rusage``).

    Raises OSError: there is no such child.
    """
    status, usage = ctypes.c_int(), _Usage()
    _checked(int(_libc.wait4(pid, ctypes.byref(status), 0, ctypes.byref(usage))), "wait4")
    cpu_ns = (usage[0] + usage[2]) * 10**9 + (usage[1] + usage[3]) * 1000
    return status.value, cpu_ns, usage[4]
