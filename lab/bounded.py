"""Bounds around a service under test, as a container would have: processes, memory, a user, no namespaces.

They need root. Without control groups the number of processes is bounded for an ordinary user only, memory not.
"""

from __future__ import annotations

import ctypes
import os
import resource
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from grader.jail import libc, syscalls

_GROUPS: Final = Path("/sys/fs/cgroup")
_MIB: Final = 1 << 20
_KEEPCAPS, _NO_NEW_PRIVS, _AMBIENT, _RAISE = 8, 38, 47, 2
_DAC_READ_SEARCH: Final = 2
_NEW_NAMESPACES: Final = (0x20000, 0x02000000, 0x04000000, 0x08000000, 0x10000000, 0x20000000, 0x40000000)


@dataclass(frozen=True, slots=True)
class Bounds:
    """How a service is bounded. `folders`: its control groups; `user`: None to stay."""

    pids: int
    memory_mib: int
    folders: tuple[Path, ...]
    user: int | None
    filter: bytes | None

    def enter(self) -> None:
        """Bound this process and all that it will start."""
        for folder in self.folders:
            (folder / "cgroup.procs").write_text("0", encoding="ascii")
        if self.user is not None:
            if not self.folders:
                resource.setrlimit(resource.RLIMIT_NPROC, (self.pids, self.pids))
            _become(self.user)
        if self.filter is not None:
            libc.prctl(_NO_NEW_PRIVS, 1)
            syscalls.load(self.filter)

    def told(self) -> str:
        """Say how it is bounded."""
        by = "control groups" if self.folders else "nothing" if self.user is None else "RLIMIT_NPROC"
        user = "root" if self.user is None else f"user {self.user}"
        names = "namespaces refused" if self.filter else "namespaces allowed"
        return f"{self.pids} processes and {self.memory_mib} MiB by {by}; {user}; {names}"

    def most_used(self) -> str:
        """Return what the control groups say about the most that was used."""
        found = []
        for folder in self.folders:
            for name in ("memory.max_usage_in_bytes", "memory.peak", "pids.peak", "pids.events"):
                with suppress(OSError):
                    found.append(f"{name} {' '.join((folder / name).read_text(encoding='ascii').split())}")
        return "; ".join(found)


@contextmanager
def bounded(pids: int, memory_mib: int, user: int | None, *, namespaces: bool) -> Iterator[Bounds]:
    """Yield bounds; their control groups are removed at the end, when nothing is in them any more."""
    folders = _made(pids, memory_mib)
    try:
        yield Bounds(pids, memory_mib, folders, user, None if namespaces else _without_namespaces())
    finally:
        for folder in folders:
            with suppress(OSError):
                folder.rmdir()


def hand_over(folder: Path, bounds: Bounds) -> None:
    """Let the service's user write in `folder`."""
    if bounds.user is not None:
        shutil.chown(folder, bounds.user, bounds.user)
        folder.chmod(0o755)


def _made(pids: int, memory_mib: int) -> tuple[Path, ...]:
    """Return new control groups, of version 2 or 1; none where they cannot be made."""
    name = f"grader-abuse-{os.getpid()}"
    limits = {"pids": {"pids.max": pids}, "memory": {"memory.max": memory_mib * _MIB, "memory.swap.max": 0}}
    if not (_GROUPS / "cgroup.controllers").exists():
        limits["memory"] = {"memory.limit_in_bytes": memory_mib * _MIB}
        parents = {_GROUPS / kind / name: values for kind, values in limits.items()}
    else:
        parents = {
            _GROUPS / name: {key: value for values in limits.values() for key, value in values.items()}
        }
    try:
        for folder, values in parents.items():
            folder.mkdir()
            for key, value in values.items():
                with suppress(FileNotFoundError):  # without swap there is nothing to bound
                    (folder / key).write_text(str(value), encoding="ascii")
    except OSError:
        return ()
    return tuple(parents)


def _become(user: int) -> None:
    """Become an ordinary user who may still read where the interpreter lies."""
    libc.prctl(_KEEPCAPS, 1)
    os.setgroups([])
    os.setresgid(user, user, user)
    os.setresuid(user, user, user)
    _inherit(1 << _DAC_READ_SEARCH)
    libc.prctl(_AMBIENT, _RAISE, _DAC_READ_SEARCH)


def _inherit(capabilities: int) -> None:
    header = (ctypes.c_uint32 * 2)(0x2008_0522, 0)
    data = (ctypes.c_uint32 * 6)(capabilities, capabilities, capabilities, 0, 0, 0)
    if ctypes.CDLL(None, use_errno=True).capset(header, data):
        raise OSError(ctypes.get_errno(), "capset")


def _without_namespaces() -> bytes:
    """Return a filter that refuses new namespaces, as Docker's default profile does."""
    import tempfile

    import pyseccomp  # type: ignore[import-untyped]

    program = pyseccomp.SyscallFilter(pyseccomp.ALLOW)
    for flag in _NEW_NAMESPACES:
        program.add_rule(pyseccomp.ERRNO(1), "clone", pyseccomp.Arg(0, pyseccomp.MASKED_EQ, flag, flag))
    for name in ("unshare", "setns", "mount", "pivot_root"):
        program.add_rule(pyseccomp.ERRNO(1), name)
    program.add_rule(pyseccomp.ERRNO(38), "clone3")
    with tempfile.TemporaryFile() as file:
        program.export_bpf(file)
        file.seek(0)
        exported: bytes = file.read()
    return exported
