"""`open` and the calls of `os` for the files in memory that a script can write to (`rclpy._storage`).

A path outside of this storage goes to the real call, and so does any path with a `dir_fd`. Calls that the tables
below do not name stay real as well: those that make links or devices, or change owners. `audit` and the sandbox
refuse them.
"""

from __future__ import annotations

import errno
import os
import stat as modes
import sys

from rclpy._kernel import kernel
from rclpy._storage import descriptors, open_files
from rclpy._storage.entries import Directory, fail
from rclpy._storage.tree import storage

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from rclpy._storage.entries import Entry, Parts

_real: dict[str, Any] = dict(vars(os))


class DirEntry:
    """What `scandir` yields in place of `os.DirEntry`."""

    def __init__(self, folder: Any, name: Any, entry: Entry) -> None:
        self.name = name
        self.path = os.path.join(folder, name)
        self._entry = entry

    def __fspath__(self) -> Any:
        return self.path

    def __repr__(self) -> str:
        return f"<DirEntry {self.name!r}>"

    def is_dir(self, *, follow_symlinks: bool = True) -> bool:
        return isinstance(self._entry, Directory)

    def is_file(self, *, follow_symlinks: bool = True) -> bool:
        return not isinstance(self._entry, Directory)

    def is_symlink(self) -> bool:
        return False

    def is_junction(self) -> bool:
        return False

    def inode(self) -> int:
        return self._entry.inode

    def stat(self, *, follow_symlinks: bool = True) -> os.stat_result:
        return self._entry.status()


class Scan:
    """Iterator over the entries that a directory had when `scandir` was called."""

    def __init__(self, directory: Directory, path: Any) -> None:
        path = os.fspath(path)
        names = [(os.fsencode(n) if isinstance(path, bytes) else n, e) for n, e in directory.entries.items()]
        self._entries = iter([DirEntry(path, name, entry) for name, entry in names])

    def __iter__(self) -> Scan:
        return self

    def __next__(self) -> DirEntry:
        return next(self._entries)

    def __enter__(self) -> Scan:
        return self

    def __exit__(self, *details: object) -> None:
        self.close()

    def close(self) -> None:
        """Drop the entries that were not yielded yet."""
        self._entries = iter(())


# ----------------------------------------------------------------------------------------------- by path


def stat(parts: Parts, path: Any, *, follow_symlinks: bool = True) -> os.stat_result:
    return storage.find(parts, path).status()


def access(path: Any, mode: int, **options: Any) -> bool:
    try:
        parts = storage.parts(path)
        if parts is None or options.get("dir_fd") is not None:
            return bool(_real["access"](storage.elsewhere(path), mode, **options))
        entry = storage.find(parts, path)
    except OSError:
        return False
    return not mode & os.X_OK or bool(entry.mode & 0o111)


def listdir(parts: Parts, path: Any) -> list[Any]:
    names = list(_directory(parts, path).entries)
    return [os.fsencode(name) for name in names] if isinstance(path, bytes) else names


def scandir(parts: Parts, path: Any) -> Scan:
    return Scan(_directory(parts, path), path)


def _directory(parts: Parts, path: Any) -> Directory:
    entry = storage.find(parts, path)
    if not isinstance(entry, Directory):
        fail(errno.ENOTDIR, path)
    return entry


def mkdir(parts: Parts, path: Any, mode: int = 0o777) -> None:
    folder = storage.folder_of(parts, path)
    if parts[-1] in folder.entries:
        fail(errno.EEXIST, path)
    storage.make_directory(folder, parts[-1], mode, path)


def rmdir(parts: Parts, path: Any) -> None:
    if _directory(parts, path).entries:
        fail(errno.ENOTEMPTY, path)
    storage.remove(_folder_of_own(parts, path), parts[-1])


def remove(parts: Parts, path: Any) -> None:
    if isinstance(storage.find(parts, path), Directory):
        fail(errno.EISDIR, path)
    storage.remove(storage.folder_of(parts, path), parts[-1])


def _folder_of_own(parts: Parts, path: Any) -> Directory:
    """Return the folder that holds an entry of the script's own; refuse the system's, such as ``/tmp`` itself."""
    if len(parts) == 1:
        fail(errno.EACCES, path)
    return storage.folder_of(parts, path)


def chmod(parts: Parts, path: Any, mode: int, **options: bool) -> None:
    entry = storage.find(parts, path)
    entry.mode = modes.S_IFMT(entry.mode) | (mode & 0o7777)
    entry.changed_ns = kernel.now_ns


def utime(
    parts: Parts,
    path: Any,
    times: tuple[float, float] | None = None,
    *,
    ns: tuple[int, int] | None = None,
    follow_symlinks: bool = True,
) -> None:
    named = path if sys.version_info >= (3, 13) else None  # before 3.13 the error of utime names no file
    entry = storage.find(parts, named)
    if ns is None:
        now = kernel.epoch_ns + kernel.now_ns
        ns = (now, now) if times is None else (int(times[0] * 1e9), int(times[1] * 1e9))
    entry.accessed_ns, entry.modified_ns = (stamp - kernel.epoch_ns for stamp in ns)


def readlink(parts: Parts, path: Any) -> Any:
    storage.find(parts, path)
    fail(errno.EINVAL, path)


def open(parts: Parts, path: Any, flags: int, mode: int = 0o777) -> int:
    return descriptors.open_path(path, parts, flags, mode)


def listxattr(parts: Parts, path: Any, **options: bool) -> list[str]:
    return []


def _by_path(
    name: str,
    in_storage: Callable[..., Any],
    by_descriptor: Callable[..., Any] | None = None,
    default: str | None = None,
) -> Callable[..., Any]:
    """Return a replacement for ``os.<name>``, which takes a path.

    For a path in the storage it calls `in_storage` with the path's parts, the path and the other arguments; for
    any other path, the real call. A descriptor of the storage in place of a path goes to `by_descriptor`.
    """
    real = _real[name]

    def call(path: Any = default, *args: Any, **options: Any) -> Any:
        if by_descriptor is not None and isinstance(path, int) and path in descriptors.descriptors:
            return by_descriptor(path, *args, **options)
        parts = storage.parts(path) if options.get("dir_fd") is None else None
        if parts is None:
            return real(storage.elsewhere(path), *args, **options)
        options.pop("dir_fd", None)
        return in_storage(parts, path, *args, **options)

    call.__name__ = call.__qualname__ = name
    return call


def chdir(path: Any) -> None:
    parts = storage.parts(path)
    if parts is not None:
        _directory(parts, path)
        storage.cwd = "/" + "/".join(parts)
    else:
        _real["chdir"](storage.elsewhere(path))
        storage.cwd = _real["getcwd"]()


def umask(mask: int, /) -> int:
    old, storage.umask = storage.umask, mask & 0o777
    return old


def getcwd() -> str:
    return storage.cwd


def getcwdb() -> bytes:
    return os.fsencode(storage.cwd)


# --------------------------------------------------------------------------------------------- two paths


def rename(src: Any, dst: Any, *, src_dir_fd: int | None = None, dst_dir_fd: int | None = None) -> None:
    """`os.rename`. On Linux `os.replace` does the same."""
    try:
        parts = storage.parts(src)
        source = _folder_of_own(parts, src) if parts is not None else None
        new_parts = storage.parts(dst)
        if source is None or new_parts is None or src_dir_fd is not None or dst_dir_fd is not None:
            _real["rename"](src, dst, src_dir_fd=src_dir_fd, dst_dir_fd=dst_dir_fd)
            return
        assert parts is not None
        target = storage.folder_of(new_parts, dst)
        entry = storage.find(parts, src)
    except OSError as error:
        fail(error.errno or errno.ENOENT, src, dst)
    if new_parts[: len(parts)] == parts and new_parts != parts:
        fail(errno.EINVAL, src, dst)
    if parts[: len(new_parts)] == new_parts and parts != new_parts:
        fail(errno.ENOTEMPTY, src, dst)
    _check_replaceable(entry, target.entries.get(new_parts[-1]), src, dst)
    storage.move(source, parts[-1], target, new_parts[-1])


def _check_replaceable(entry: Entry, old: Entry | None, src: Any, dst: Any) -> None:
    """Refuse to rename `entry` over `old` where Linux refuses it."""
    if old is None:
        if not isinstance(entry, Directory) and os.fsencode(dst).endswith(b"/"):
            fail(errno.ENOTDIR, src, dst)
        return
    if isinstance(old, Directory) and not isinstance(entry, Directory):
        fail(errno.EISDIR, src, dst)
    if isinstance(entry, Directory) and not isinstance(old, Directory):
        fail(errno.ENOTDIR, src, dst)
    if isinstance(old, Directory) and old.entries and old is not entry:
        fail(errno.ENOTEMPTY, src, dst)


def replace(src: Any, dst: Any, *, src_dir_fd: int | None = None, dst_dir_fd: int | None = None) -> None:
    rename(src, dst, src_dir_fd=src_dir_fd, dst_dir_fd=dst_dir_fd)


# ---------------------------------------------------------------------------------------- by descriptor


def _by_descriptor(name: str, in_storage: Callable[..., Any]) -> Callable[..., Any]:
    """Return a replacement for ``os.<name>``: `in_storage` for a descriptor of the storage, else the real call."""
    real = _real[name]

    def call(fd: Any, *args: Any, **options: Any) -> Any:
        if isinstance(fd, int) and fd in descriptors.descriptors:
            return in_storage(fd, *args, **options)
        return real(fd, *args, **options)

    call.__name__ = call.__qualname__ = name
    return call


# -------------------------------------------------------------------------------------------------- tables

_PATHS: dict[str, tuple[Any, ...]] = {
    "chmod": (chmod,),
    "listdir": (listdir, None, "."),
    "listxattr": (listxattr,),
    "lstat": (stat,),
    "mkdir": (mkdir,),
    "open": (open,),
    "readlink": (readlink,),
    "remove": (remove,),
    "rmdir": (rmdir,),
    "scandir": (scandir, None, "."),
    "stat": (stat, descriptors.fstat),
    "unlink": (remove,),
    "utime": (utime,),
}
REPLACED: dict[str, object] = {
    **{name: _by_path(name, *calls) for name, calls in _PATHS.items() if name in _real},
    **{name: _by_descriptor(name, call) for name, call in descriptors.CALLS.items() if name in _real},
    "access": access,
    "chdir": chdir,
    "getcwd": getcwd,
    "getcwdb": getcwdb,
    "rename": rename,
    "replace": replace,
    "umask": umask,
}
"""What replaces the functions of `os`, by name."""

REPLACED_OPEN: dict[str, object] = {"open": open_files.open}
"""What replaces `open` in `io` and among the builtins."""
