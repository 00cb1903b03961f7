"""Open files of `storage` by number, as `os.open` gives them.

The operating system never gives these numbers (the sandbox allows 64 descriptors). So a call that is not patched
fails with "Bad file descriptor" instead of reaching a real file.
"""

from __future__ import annotations

import errno
import os

from rclpy._storage.entries import Directory, File, fail
from rclpy._storage.tree import storage

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from rclpy._storage.entries import Parts

FIRST_DESCRIPTOR = 1000
MOST_OPEN = 1024
"""What a PC allows (`ulimit -n`)."""

_ACCESS = os.O_RDONLY | os.O_WRONLY | os.O_RDWR


class Description:
    """An open file: where it is read or written next."""

    def __init__(self, file: File, flags: int) -> None:
        self.file = file
        self.position = 0
        self.readable = flags & _ACCESS != os.O_WRONLY
        self.writable = flags & _ACCESS != os.O_RDONLY
        self.appending = bool(flags & os.O_APPEND)

    def read(self, size: int) -> bytes:
        """Return the next bytes, at most `size`. Raises OSError: it is open for writing only."""
        if not self.readable:
            fail(errno.EBADF)
        data = bytes(self.file.data[self.position : self.position + size])
        self.position += len(data)
        return data

    def write(self, data: Any) -> int:
        """Write what there is room for; return how many bytes that was.

        Raises OSError: it is open for reading only, or the storage is full.
        """
        if not self.writable:
            fail(errno.EBADF)
        if self.appending:
            self.position = len(self.file.data)
        written = storage.write(self.file, self.position, memoryview(data).cast("B"))
        self.position += written
        return written

    def seek(self, offset: int, whence: int) -> int:
        """Set the position; return it. Raises OSError: before the beginning, or of an unknown kind."""
        bases = {os.SEEK_SET: 0, os.SEEK_CUR: self.position, os.SEEK_END: len(self.file.data)}
        if whence not in bases or bases[whence] + offset < 0:
            fail(errno.EINVAL)
        self.position = bases[whence] + offset
        return self.position


descriptors: dict[int, Description] = {}


def enter(description: Description, path: Any = None) -> int:
    """Return a new descriptor, the lowest that is free. Raises OSError: too many are open."""
    number = FIRST_DESCRIPTOR
    while number in descriptors:
        number += 1
    if number >= FIRST_DESCRIPTOR + MOST_OPEN:
        fail(errno.EMFILE, path)
    descriptors[number] = description
    description.file.openers += 1
    return number


def close(number: int) -> None:
    """Close a descriptor. Raises OSError: it is not open."""
    description = described(number)
    del descriptors[number]
    description.file.openers -= 1
    storage.forget(description.file)


def described(number: int) -> Description:
    """Return what a descriptor stands for. Raises OSError: it is not open."""
    if number not in descriptors:
        fail(errno.EBADF)
    return descriptors[number]


def open_path(path: Any, parts: Parts, flags: int, mode: int = 0o666) -> int:
    """Open a file of the storage as `os.open` does; return its descriptor. Raises as `os.open`."""
    file = _file_at(path, parts, flags, mode)
    if flags & os.O_TRUNC and flags & _ACCESS != os.O_RDONLY:
        storage.resize(file, 0)
    return enter(Description(file, flags), path)


def _file_at(path: Any, parts: Parts, flags: int, mode: int) -> File:
    if flags & os.O_CREAT:
        folder = storage.folder_of(parts, path)
        entry = folder.entries.get(parts[-1])
        if entry is None:
            if os.fsencode(path).endswith(b"/"):
                fail(errno.EISDIR, path)
            return storage.make_file(folder, parts[-1], mode, path)
        if flags & os.O_EXCL:
            fail(errno.EEXIST, path)
    else:
        entry = storage.find(parts, path)
    if isinstance(entry, Directory):
        fail(errno.EISDIR, path)
    assert isinstance(entry, File)
    if flags & getattr(os, "O_DIRECTORY", 0):
        fail(errno.ENOTDIR, path)
    return entry


# What `os` has for descriptors ------------------------------------------------------------------------


def read(fd: int, length: int, /) -> bytes:
    return described(fd).read(length)


def write(fd: int, data: Any, /) -> int:
    return described(fd).write(data)


def lseek(fd: int, position: int, whence: int, /) -> int:
    return described(fd).seek(position, whence)


def fstat(fd: int) -> os.stat_result:
    return described(fd).file.status()


def fsync(fd: int) -> None:
    described(fd)


CALLS: dict[str, Callable[..., Any]] = {
    "close": close,
    "fstat": fstat,
    "fsync": fsync,
    "lseek": lseek,
    "read": read,
    "write": write,
}
"""Names of `os` and what does the same here."""
