"""Give the zygote its own small world: namespaces and a root directory that holds only what may be read.

Entered once, by the zygote, so that a run does not pay for it. Standard library only.
"""

import ctypes
import os
import signal
import stat
from collections.abc import Iterable, Sequence

from . import libc

_MS_NOSUID, _MS_BIND, _MS_REC, _MS_PRIVATE = 2, 4096, 16384, 1 << 18
_AT_FDCWD, _AT_RECURSIVE = -100, 0x8000
_MOUNT_ATTR_RDONLY, _MOUNT_ATTR_NOSUID = 1, 2
_STAGE = "/tmp"  # noqa: S108 - covered by an own, private mount before anything is made in it


class _MountAttr(ctypes.Structure):
    _fields_ = (
        ("attr_set", ctypes.c_uint64),
        ("attr_clr", ctypes.c_uint64),
        ("propagation", ctypes.c_uint64),
        ("userns_fd", ctypes.c_uint64),
    )


def enter(shown: Iterable[str], masked: Sequence[str]) -> bool:
    """Move to new namespaces and a new root; the caller goes on as process 1 of the new process namespace.

    The former process stays behind only to pass on the exit status.

    Args:
        shown: files and directories that the new root shows, read-only, under their own names.
        masked: directories directly below one of `shown` that are covered by empty ones; what follows in
            `shown` may lie in them.

    Returns:
        False, with nothing changed, where the host allows no new namespaces at all.

    Raises:
        OSError: the host allows them but refused a later step; this process is of no use any more.
    """
    uid, gid = os.geteuid(), os.getegid()
    flags = (
        libc.CLONE_NEWNS | libc.CLONE_NEWPID | libc.CLONE_NEWNET | libc.CLONE_NEWIPC | libc.CLONE_NEWUTS
        | libc.CLONE_NEWCGROUP
    )  # fmt: skip
    try:
        libc.unshare(flags if uid == 0 else flags | libc.CLONE_NEWUSER)
    except OSError:
        return False
    if uid != 0:
        _map_identity(uid, gid)
    _continue_in_child()
    sources = [(path, os.open(path, os.O_PATH | os.O_CLOEXEC)) for path in shown]
    _change_root(sources, masked)
    return True


def _change_root(sources: list[tuple[str, int]], masked: Sequence[str]) -> None:
    """Build the new root out of `sources` (path, descriptor of it) and make it the only file system."""
    os.umask(0o022)  # scripts of another user must pass its folders, whatever the operator's own is
    libc.mount("none", "/", "", _MS_REC | _MS_PRIVATE)
    libc.mount("tmpfs", _STAGE, "tmpfs", _MS_NOSUID, "size=1m,nr_inodes=4096,mode=755")
    for path, descriptor in sources:
        _show(path, descriptor)
        for inner in masked:
            if os.path.dirname(inner) == path:
                libc.mount("tmpfs", _STAGE + inner, "tmpfs", _MS_NOSUID, "size=64k,nr_inodes=128,mode=755")
    _set_read_only(_STAGE)
    os.chdir(_STAGE)
    libc.syscall("pivot_root", libc.NR_PIVOT_ROOT[libc.MACHINE], b".", b".")
    libc.umount_lazily(".")
    os.chdir("/")


def _map_identity(uid: int, gid: int) -> None:
    for name, text in (("setgroups", "deny"), ("uid_map", f"{uid} {uid} 1"), ("gid_map", f"{gid} {gid} 1")):
        with open(f"/proc/self/{name}", "w") as file:
            file.write(text)


def _continue_in_child() -> None:
    pid = os.fork()
    if pid == 0:
        libc.prctl(libc.PR_SET_PDEATHSIG, signal.SIGKILL)
        return
    os.closerange(0, 256)  # the supervisor must see the end of the zygote, not of this process
    _, status = os.waitpid(pid, 0)
    os._exit(os.waitstatus_to_exitcode(status) & 0xFF)


def _show(path: str, descriptor: int) -> None:
    target = _STAGE + path
    os.makedirs(os.path.dirname(target), mode=0o755, exist_ok=True)
    if stat.S_ISDIR(os.fstat(descriptor).st_mode):
        os.makedirs(target, mode=0o755, exist_ok=True)
    else:
        os.close(os.open(target, os.O_CREAT | os.O_WRONLY | os.O_CLOEXEC, 0o644))
    libc.mount(f"/proc/self/fd/{descriptor}", target, "", _MS_BIND)
    os.close(descriptor)


def _set_read_only(path: str) -> None:
    attributes = _MountAttr(attr_set=_MOUNT_ATTR_RDONLY | _MOUNT_ATTR_NOSUID)
    libc.syscall(
        "mount_setattr",
        libc.NR_MOUNT_SETATTR,
        _AT_FDCWD,
        os.fsencode(path),
        _AT_RECURSIVE,
        ctypes.byref(attributes),
        ctypes.sizeof(attributes),
    )
