"""A root directory made ahead, which holds only what a script may read: for a host without Landlock.

Some containers run their programs as root, may change their root directory and their user, and have a kernel or an
engine that refuses Landlock. There this directory takes Landlock's place: the zygote makes it its root before any
script comes, and each run then has a user id to which no file in it belongs. Hard links where possible, so that it
takes hardly any room; it is made again whenever what it was made of has changed.
"""

import hashlib
import json
import os
import shutil
import stat
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

# Not `prefix`: a child without `site` has another.
PLACE: Final = Path(sys.executable).parents[1] / "jail-root"
_STAMP: Final = "jail-root.json"
_OPEN: Final = 0o755
_PASSABLE: Final = 0o711  # nobody but root lists the folders on the way
_CHANGEABLE: Final = stat.S_IWGRP | stat.S_IWOTH
_DEVICES: Final = {"/dev/null": (0o666, os.makedev(1, 3)), "/dev/urandom": (0o444, os.makedev(1, 9))}


def prepare(shown: Sequence[str], masked: Sequence[str], place: Path) -> None:
    """Make the directory anew.

    Args:
        shown: files and directories that it shows under their own names.
        masked: directories directly below one of `shown` that are left out.
        place: where it is made; a stamp beside it says what it was made from.

    Raises:
        OSError: it could not be made: not root, no right to make devices, no room.
    """
    _stamp_of(place).unlink(missing_ok=True)
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir(mode=_PASSABLE, parents=True)
    place.chmod(_PASSABLE)
    for name, (mode, device) in _DEVICES.items():
        target = _below(place, name)
        os.mknod(target, stat.S_IFCHR | mode, device)
        target.chmod(mode)
    for top in shown:
        if os.path.isdir(top):
            hides = any(os.path.dirname(inner) == top for inner in masked)  # so its names are not told either
            _make_folder(_below(place, top), _PASSABLE if hides else _OPEN)
        else:
            _copy(os.path.realpath(top), _below(place, top))
        for source in _inside(top, masked):
            _copy(source, _below(place, source))
    _stamp_of(place).write_text(json.dumps({"sources": _digest(shown, masked)}), "ascii")


def is_ready(shown: Sequence[str], masked: Sequence[str], place: Path) -> bool:
    """Return whether the directory is there, belongs to root alone, and shows what is there now."""
    try:
        stamp = json.loads(_stamp_of(place).read_text("ascii"))
        status = place.stat()
    except (OSError, ValueError):
        return False
    mine = status.st_uid == 0 and not status.st_mode & _CHANGEABLE
    return mine and stamp == {"sources": _digest(shown, masked)}


def _stamp_of(place: Path) -> Path:
    return place.with_name(_STAMP)


def _below(place: Path, name: str) -> Path:
    """Return where `name` stands in the directory; the folders on the way are made."""
    target = place / name.lstrip("/")
    for folder in reversed(target.parents):
        if place in folder.parents and not folder.exists():
            folder.mkdir(mode=_PASSABLE)
            folder.chmod(_PASSABLE)
    return target


def _inside(top: str, masked: Sequence[str]) -> Iterator[str]:
    """Yield folders, files and links below a directory, a folder before what is in it; nothing below a file."""
    for folder, folders, files in os.walk(top):
        folders[:] = sorted(name for name in folders if os.path.join(folder, name) not in masked)
        for name in (*folders, *sorted(files)):
            yield os.path.join(folder, name)


def _make_folder(target: Path, mode: int = _OPEN) -> None:
    target.mkdir(exist_ok=True)
    target.chmod(mode)


def _copy(source: str, target: Path) -> None:
    """Show a file, link or folder; what another user's rights come with, and devices, are left out.

    A file that others than root may change is copied: a script could empty it here, and so the grader's own.
    """
    status = os.lstat(source)
    mode = status.st_mode
    if stat.S_ISDIR(mode):
        _make_folder(target)
    elif os.path.lexists(target):  # two of the directories are one, under two names
        return
    elif stat.S_ISLNK(mode):
        target.symlink_to(os.readlink(source))
    elif stat.S_ISREG(mode) and not mode & (stat.S_ISUID | stat.S_ISGID):
        if status.st_uid == 0 and not mode & _CHANGEABLE and _linked(source, target):
            return
        shutil.copyfile(source, target)
        target.chmod(stat.S_IMODE(mode) & ~_CHANGEABLE)
        os.utime(target, ns=(status.st_atime_ns, status.st_mtime_ns))


def _linked(source: str, target: Path) -> bool:
    """Link a file; return whether it could be."""
    try:
        os.link(source, target)
    except OSError:  # another file system
        return False
    return True


def _digest(shown: Sequence[str], masked: Sequence[str]) -> str:
    """Return what tells whether the sources have changed; byte code, which comes by itself, does not count."""
    digest = hashlib.sha256()
    for top in shown:
        for path in (top, *_inside(top, masked)):
            status = os.lstat(path)
            if "__pycache__" not in path and not stat.S_ISDIR(status.st_mode):
                line = f"{path}\0{status.st_mode}\0{status.st_uid}\0{status.st_size}\0{status.st_mtime_ns}\n"
                digest.update(line.encode(errors="surrogateescape"))
    return digest.hexdigest()
