"""`os.scandir` of a directory of the storage."""

from __future__ import annotations

import os

from rclpy._entries import Directory

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from rclpy._entries import Entry


class DirEntry:
    """What `scandir` yields; stands for `os.DirEntry`."""

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
    """Iterator over the entries there were when it was made."""

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
        """Yield no more."""
        self._entries = iter(())
