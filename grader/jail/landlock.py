"""File, network and signal confinement by Landlock(7). Standard library only: imported by the zygote."""

import ctypes
import os
import sys
from collections.abc import Iterable

from .libc import (
    NR_LANDLOCK_ADD_RULE,
    NR_LANDLOCK_CREATE_RULESET,
    NR_LANDLOCK_RESTRICT_SELF,
    syscall,
)

_CREATE_RULESET_VERSION = 1
_RULE_PATH_BENEATH = 1
_WRITE_FILE, _READ_FILE, _READ_DIR = 1 << 1, 1 << 2, 1 << 3
# Rights known to each version of the interface: 13 at first, then refer, truncate, device ioctl.
_FS_RIGHTS = {1: (1 << 13) - 1, 2: (1 << 14) - 1, 3: (1 << 15) - 1, 4: (1 << 15) - 1, 5: (1 << 16) - 1}
_NET_RIGHTS = 0b11  # TCP bind and connect, since version 4
_SCOPES = 0b11  # abstract sockets and signals, since version 6


class _RulesetAttr(ctypes.Structure):
    _fields_ = (
        ("handled_access_fs", ctypes.c_uint64),
        ("handled_access_net", ctypes.c_uint64),
        ("scoped", ctypes.c_uint64),
    )


class _PathBeneathAttr(ctypes.Structure):
    _pack_ = 1
    _fields_ = (("allowed_access", ctypes.c_uint64), ("parent_fd", ctypes.c_int32))


def abi_version() -> int:
    """Return the version of Landlock's interface, 0 when the kernel has none or refuses it."""
    if sys.platform != "linux":
        return 0
    try:
        return syscall(
            "landlock_create_ruleset", NR_LANDLOCK_CREATE_RULESET, None, 0, _CREATE_RULESET_VERSION
        )
    except OSError:
        return 0


def create_ruleset(readable: Iterable[str], writable_devices: Iterable[str]) -> int:
    """Return a descriptor of rules that allow reading `readable` and opening `writable_devices`, no more.

    Paths that do not exist are left out. All other file access, all TCP and, where the kernel knows them,
    signals and abstract sockets to outside are refused once the rules are applied.

    Raises OSError: this kernel has no Landlock.
    """
    abi = abi_version()
    attr = _RulesetAttr(
        handled_access_fs=_FS_RIGHTS[max(1, min(abi, 5))],
        handled_access_net=_NET_RIGHTS if abi >= 4 else 0,
        scoped=_SCOPES if abi >= 6 else 0,
    )
    size = 24 if abi >= 6 else 16 if abi >= 4 else 8
    ruleset = syscall("landlock_create_ruleset", NR_LANDLOCK_CREATE_RULESET, ctypes.byref(attr), size, 0)
    for path in readable:
        _allow(ruleset, path, _READ_FILE | (_READ_DIR if os.path.isdir(path) else 0))
    for path in writable_devices:
        _allow(ruleset, path, _READ_FILE | _WRITE_FILE)
    return ruleset


def _allow(ruleset: int, path: str, rights: int) -> None:
    try:
        parent = os.open(path, os.O_PATH | os.O_CLOEXEC)
    except FileNotFoundError:
        return
    try:
        rule = _PathBeneathAttr(allowed_access=rights, parent_fd=parent)
        syscall("landlock_add_rule", NR_LANDLOCK_ADD_RULE, ruleset, _RULE_PATH_BENEATH, ctypes.byref(rule), 0)
    finally:
        os.close(parent)


def restrict_self(ruleset: int) -> None:
    """Apply `ruleset` to this thread and all it starts, for ever. Needs no_new_privs.

    Raises OSError: the kernel refused.
    """
    syscall("landlock_restrict_self", NR_LANDLOCK_RESTRICT_SELF, ruleset, 0)
