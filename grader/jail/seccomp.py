"""Load the shipped seccomp filter. Standard library only: imported by the zygote."""

import ctypes
import os
import struct

from . import policy
from .libc import MACHINE, NR_SECCOMP, syscall

_SECCOMP_SET_MODE_FILTER = 1
_INSTRUCTION_BYTES = 8
_OWN_PID = struct.pack("<I", policy.OWN_PID)


class _Program(ctypes.Structure):
    _fields_ = (("length", ctypes.c_ushort), ("instructions", ctypes.c_char_p))


def read_filter(directory: str, machine: str = MACHINE) -> bytes:
    """Return the filter shipped for `machine`.

    Raises:
        OSError: there is none for this architecture.
    """
    with open(os.path.join(directory, f"{machine}.bpf"), "rb") as file:
        return file.read()


def bind_to_process(program: bytes, pid: int) -> bytes:
    """Return `program` with the placeholder of the process's own id replaced by `pid`.

    Raises:
        ValueError: the program has no placeholder, so it is not the filter of this policy.
    """
    if _OWN_PID not in program:
        raise ValueError("the seccomp filter does not belong to this policy")
    return program.replace(_OWN_PID, struct.pack("<I", pid))


def load(program: bytes) -> None:
    """Confine this thread and all it starts to `program`, for ever. Needs no_new_privs.

    Raises:
        OSError: the kernel refused.
    """
    argument = _Program(len(program) // _INSTRUCTION_BYTES, program)
    syscall("seccomp", NR_SECCOMP[MACHINE], _SECCOMP_SET_MODE_FILTER, 0, ctypes.byref(argument))
