"""The folder that a run may write to: in this process's memory, and gone with it.

The sandbox lets no script write a file anywhere, on any host. What a script writes to its home or to ``/tmp``
stands here instead, alike with and without namespaces: nothing of it reaches a file system, another run or
another process, nothing of it can be executed or mapped, and its bytes count as the script's own memory.
`open_files` has the file objects for it, `rclpy._patches.files` the calls of `os`.

Only paths below `_TOPS` are here. The interpreter's own files are not, wherever they lie.
"""

from __future__ import annotations

import errno
import os
import sys

from rclpy._storage.entries import USER, WORK, Directory, Entry, File, fail, split, touch

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeVar

    from rclpy._storage.entries import Parts

    Made = TypeVar("Made", File, Directory)

CAPACITY_BYTES = 16 * 1024 * 1024
"""What all files together may hold; a minute of poses as text is less than one MiB."""
MOST_ENTRIES = 1000
"""Files and directories there may be; as for `CAPACITY_BYTES`, one more is "No space left on device"."""

_TOPS = ("home", "root", "tmp")
_HOMES = ("home", "root")
_WORK = ("home", USER, "ros2_ws")
_NAME_BYTES = 255
_PATH_BYTES = 4096
_FIRST_INODE = 1_000_000
_PACKAGES = ("numpy", "yaml")  # what a script may import besides the standard library; on no path


def _installed() -> tuple[str, ...]:
    """Return the directories below which the interpreter and all that may be imported are installed."""
    paths = {*sys.path, sys.base_prefix}
    for name in _PACKAGES:
        specs = (finder.find_spec(name, None) for finder in sys.meta_path)
        paths.update(os.path.dirname(os.path.dirname(spec.origin)) for spec in specs if spec and spec.origin)
    return tuple(f"{path}/" for path in paths if path not in ("", "/"))


class Storage:
    """All that a run has written; use the module's one object `storage`.

    Attributes:
        cwd: the working directory, here or elsewhere.
        umask: permissions that new entries do not get.
    """

    def __init__(self) -> None:
        self.cwd = WORK
        self.umask = 0o022
        self._root = Directory(2, 0o755)
        self._inodes = 0
        self._count = 0
        self._used_bytes = 0
        self._real = _installed()
        for name in _TOPS:
            self.make_directory(self._root, name, 0o755)
        self._work = self._root
        for name in _WORK:
            inner = self._work.entries.get(name)
            self._work = (
                inner if isinstance(inner, Directory) else self.make_directory(self._work, name, 0o755)
            )
        self._script = File(self._new_inode(None), 0o644)  # made ahead, so that a start costs little

    def place_script(self, file_name: str, source: bytes) -> None:
        """Put the script into the working directory, which is empty otherwise."""
        self._work.entries[file_name.rpartition("/")[2] or "student.py"] = self._script
        self._script.data += source
        self._used_bytes += len(source)

    def place(self, path: str, data: bytes) -> File:
        """Make a file of the student's package, and its folders; `MOST_ENTRIES` does not count them."""
        folder, name = self._folder_for(path)
        file = self.make_file(folder, name, 0o644)
        self._count -= 1
        file.data += data
        self._used_bytes += len(data)
        return file

    def link(self, path: str, file: File) -> None:
        """Give a file that `place` made a second path."""
        folder, name = self._folder_for(path)
        folder.entries[name] = file

    def _folder_for(self, path: str) -> tuple[Directory, str]:
        """Return the folder of a path, made if missing, and the path's last name."""
        *names, last = split(path)
        folder = self._root
        for name in names:
            inner = folder.entries.get(name)
            if not isinstance(inner, Directory):
                inner = self.make_directory(folder, name, 0o755)
                self._count -= 1
            folder = inner
        return folder, last

    # Paths --------------------------------------------------------------------------------------------

    def parts(self, path: Any) -> Parts | None:
        """Return the names that lead to `path` in this storage; None if it lies elsewhere or is no path.

        Raises:
            OSError: the path, or a name in it, is too long.
            ValueError: there is a zero byte in it.
        """
        try:
            text = os.fsdecode(path)
        except TypeError:
            return None
        if not text:
            fail(errno.ENOENT, path)
        found = split(text if text[:1] == "/" else f"{self.cwd}/{text}")
        if not found or found[0] not in _TOPS:
            return None
        absolute = "/" + "/".join(found)
        if f"{absolute}/".startswith(self._real):
            return None
        if "\0" in absolute:
            raise ValueError("embedded null byte")
        encoded = os.fsencode(absolute)
        if len(encoded) >= _PATH_BYTES or any(len(name) > _NAME_BYTES for name in encoded.split(b"/")):
            fail(errno.ENAMETOOLONG, path)
        if ".." in text or text[-1] in "/.":
            self._check_steps(text, found, path)
        return found

    def _check_steps(self, text: str, found: Parts, path: Any) -> None:
        """Check what `split` has dropped from a path: ``..`` and a final slash must follow a directory.

        A final slash may also follow a name that does not exist yet.

        Raises OSError: one of them does not.
        """
        names = (text if text[0] == "/" else f"{self.cwd}/{text}").split("/")
        for place, name in enumerate(names):
            before = split("/".join(names[:place]))
            if name == ".." and before[:1] and before[0] in _TOPS:
                self.find((*before, ""), path)
        if names[-1] in ("", "."):
            try:
                self.find((*found, ""), path)
            except FileNotFoundError:
                return  # it may be about to be made

    def elsewhere(self, path: Any) -> Any:
        """Return a path outside this storage as an absolute one: the process's own directory is not `cwd`."""
        if isinstance(path, (str, bytes)) and path and os.fsencode(path)[:1] != b"/":
            absolute = "/" + "/".join(split(f"{self.cwd}/{os.fsdecode(path)}"))
            return os.fsencode(absolute) if isinstance(path, bytes) else absolute
        return path

    def find(self, parts: Parts, path: object) -> Entry:
        """Return the entry at `parts`; with an empty last part it must be a directory.

        Raises OSError: there is no such entry (the error names `path`).
        """
        entry: Entry = self._root
        for name in parts:
            if not isinstance(entry, Directory):
                fail(errno.ENOTDIR, path)
            if name and name not in entry.entries:
                fail(errno.ENOENT, path)
            entry = entry.entries[name] if name else entry
        return entry

    def folder_of(self, parts: Parts, path: object) -> Directory:
        """Return the directory that is to hold the last of `parts`.

        A student's home may contain any directory, so one that a script expects there is made. In the working
        directory and in ``/tmp``, which begin empty, a missing directory is an error.

        Raises OSError: there is no such directory.
        """
        generous = parts[0] in _HOMES and parts[: len(_WORK)] != _WORK
        folder = self._root
        for name in parts[:-1]:
            inner = folder.entries.get(name)
            if inner is None and generous:
                inner = self.make_directory(folder, name, 0o755, path)
            if inner is None:
                fail(errno.ENOENT, path)
            if not isinstance(inner, Directory):
                fail(errno.ENOTDIR, path)
            folder = inner
        return folder

    # Entries ------------------------------------------------------------------------------------------

    def make_file(self, folder: Directory, name: str, mode: int, path: object = None) -> File:
        """Return a new, empty file. Raises OSError: there are too many entries."""
        return self._make(File, folder, name, mode, path)

    def make_directory(self, folder: Directory, name: str, mode: int, path: object = None) -> Directory:
        """Return a new, empty directory. Raises OSError: there are too many entries."""
        return self._make(Directory, folder, name, mode, path)

    def _make(self, kind: type[Made], folder: Directory, name: str, mode: int, path: object) -> Made:
        entry = kind(self._new_inode(path), mode & ~self.umask)
        folder.entries[name] = entry
        touch(folder)
        return entry

    def _new_inode(self, path: object) -> int:
        if self._count >= MOST_ENTRIES:
            fail(errno.ENOSPC, path)
        self._count += 1
        self._inodes += 1
        return _FIRST_INODE + self._inodes

    def remove(self, folder: Directory, name: str) -> None:
        """Take an entry out of `folder`; a file that is open lives on until it is closed."""
        entry = folder.entries.pop(name)
        touch(folder)
        self._count -= 1
        if isinstance(entry, File):
            entry.named = False
            self.forget(entry)

    def move(self, source: Directory, name: str, target: Directory, new_name: str) -> None:
        """Give an entry another place and name; what stood there is gone."""
        if source.entries[name] is target.entries.get(new_name):
            return
        if new_name in target.entries:
            self.remove(target, new_name)
        target.entries[new_name] = source.entries.pop(name)
        touch(source)
        touch(target)

    def forget(self, file: File) -> None:
        """Give the space of `file` back when it has neither a name nor anyone who has it open."""
        if not file.named and file.openers == 0:
            self._used_bytes -= len(file.data)
            file.data = bytearray()

    # Bytes --------------------------------------------------------------------------------------------

    def write(self, file: File, at: int, data: bytes | memoryview) -> int:
        """Write at `at` what there is room for (zeros before it, beyond the end); return how many bytes.

        Raises OSError: there is no room.
        """
        size = len(file.data)
        room = CAPACITY_BYTES - self._used_bytes + size - at
        if len(data) > room:
            data = data[: max(room, 0)]
            if not data:
                fail(errno.ENOSPC)
        if at > size:
            self.resize(file, at)
        file.data[at : at + len(data)] = data
        self._used_bytes += len(file.data) - max(size, at)
        touch(file)
        return len(data)

    def resize(self, file: File, size: int) -> None:
        """Cut `file`, or lengthen it with zeros. Raises OSError: there is no room."""
        growth = size - len(file.data)
        if self._used_bytes + growth > CAPACITY_BYTES:
            fail(errno.ENOSPC)
        if growth > 0:
            file.data += bytes(growth)
        else:
            del file.data[size:]
        self._used_bytes += growth
        touch(file)


storage = Storage()
