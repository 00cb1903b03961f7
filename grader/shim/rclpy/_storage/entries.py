"""Files and directories of a run's own storage, and what refused calls raise."""

from __future__ import annotations

import os
import stat

from rclpy._kernel import kernel

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, NoReturn

USER = "student"
HOME = f"/home/{USER}"
WORK = f"{HOME}/ros2_ws"
"""The working directory."""
UID = 1000
DEVICE = 2049
BLOCK_BYTES = 4096

Parts = tuple[str, ...]
"""An absolute path without ``.`` and ``..``, as the names on the way from ``/``."""


def fail(number: int, path: object = None, target: object = None) -> NoReturn:
    """Raise what a refused call raises.

    Raises OSError: of the subclass that belongs to `number`, about `path` if any (and `target`, of two).
    """
    if isinstance(path, os.PathLike):
        path = os.fspath(path)
    if target is None:
        raise OSError(number, os.strerror(number), *(() if path is None else (path,)))
    if isinstance(target, os.PathLike):
        target = os.fspath(target)
    raise OSError(number, os.strerror(number), path, None, target)


def split(path: str) -> Parts:
    """Return the names in `path`, ``.`` and ``..`` resolved."""
    names: list[str] = []
    for name in path.split("/"):
        if name == "..":
            del names[-1:]
        elif name not in ("", "."):
            names.append(name)
    return tuple(names)


class Entry:
    """A file or a directory; its times are virtual."""

    def __init__(self, inode: int, mode: int) -> None:
        self.inode = inode
        self.mode = mode
        self.accessed_ns = self.modified_ns = self.changed_ns = kernel.now_ns

    def size(self) -> int:
        """Return the size in bytes."""
        return BLOCK_BYTES

    def status(self) -> os.stat_result:
        """Return what `os.stat` says of it."""
        stamps = {"atime": self.accessed_ns, "mtime": self.modified_ns, "ctime": self.changed_ns}
        more: dict[str, Any] = {"st_blksize": BLOCK_BYTES, "st_blocks": -(-self.size() // 512), "st_rdev": 0}
        whole = []
        for name, stamp_ns in stamps.items():
            ns = kernel.epoch_ns + stamp_ns
            more[f"st_{name}"] = ns / 1e9
            more[f"st_{name}_ns"] = ns
            whole.append(ns // 1_000_000_000)
        return os.stat_result((self.mode, self.inode, DEVICE, 1, UID, UID, self.size(), *whole), more)


class File(Entry):
    """A file's bytes, which stay as long as it has a name or is open."""

    def __init__(self, inode: int, mode: int) -> None:
        super().__init__(inode, stat.S_IFREG | mode)
        self.data = bytearray()
        self.named = True
        self.openers = 0

    def size(self) -> int:
        return len(self.data)


class Directory(Entry):
    """Entries by name, in the order in which they were made."""

    def __init__(self, inode: int, mode: int) -> None:
        super().__init__(inode, stat.S_IFDIR | mode)
        self.entries: dict[str, Entry] = {}


def touch(entry: Entry) -> None:
    """Note that `entry` is changed now; looking at the clock here costs the script nothing."""
    entry.modified_ns = entry.changed_ns = kernel.now_ns
