"""Validated assignments, kept on disk from one command to the next, and in the memory of a service.

Validating a file needs pydantic and a YAML parser, and importing these takes longer than a whole grading. An entry
on disk holds for exactly the bytes of the assignment's files and of the code that validated them, as a ``.pyc``
file does for its source: nothing ever has to be cleared. A damaged entry, or one that cannot be written, costs
only the time that it would have saved.
"""

import hashlib
import json
import os
from contextlib import suppress
from functools import cached_property
from pathlib import Path
from typing import Any, Final

from grader import __version__, contracts
from grader.catalog.files import content
from grader.contracts.assignment import Assignment
from grader.contracts.record import from_plain, to_plain

_GRADER: Final = Path(contracts.__path__[0]).parent
_VALIDATORS: Final = (
    *sorted(Path(__file__).parent.glob("*.py")),
    *sorted(Path(contracts.__path__[0]).glob("*.py")),
    _GRADER / "formats" / "__init__.py",
    _GRADER / "formats" / "interfaces.py",
    _GRADER / "geometry" / "exact.py",
    _GRADER / "geometry" / "room.py",
    _GRADER / "shim" / "rosidl_data" / "humble.txt",
)
"""Every file that decides what a valid assignment is, and what it means."""


def default_cache_folder() -> Path | None:
    """Return the folder for this user's entries; None where neither XDG_CACHE_HOME nor HOME names one."""
    base = os.environ.get("XDG_CACHE_HOME", "")
    if os.path.isabs(base):
        return Path(base, "grader")
    home = os.environ.get("HOME", "")
    return Path(home, ".cache", "grader") if os.path.isabs(home) else None


class AssignmentMemory:
    """Validated assignments in memory, for a process that asks for them every few seconds."""

    def __init__(self) -> None:
        self._known: dict[Path, tuple[bytes, Assignment]] = {}

    def find(self, path: Path) -> Assignment | None:
        """Return the assignment that was kept for `path`; None if there is none or a file has changed since."""
        entry = self._known.get(path)
        try:
            return entry[1] if entry is not None and entry[0] == content(path) else None
        except OSError:
            return None

    def keep(self, path: Path, source: bytes, assignment: Assignment) -> None:
        """Keep `assignment`, the result of validating `source`, which is the content of the files at `path`."""
        self._known[path] = source, assignment


class AssignmentCache:
    """Validated assignments under one folder, one file for each ``assignment.yaml``."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def find(self, path: Path) -> Assignment | None:
        """Return the assignment that was kept for `path`; None if there is none or a file has changed since."""
        try:
            entry = json.loads(self._file(path).read_bytes())
            if entry["key"] != self._key(path):
                return None
            return from_plain(Assignment, entry["assignment"])
        except (OSError, ValueError, KeyError, TypeError):
            return None

    def keep(self, path: Path, source: bytes, assignment: Assignment) -> None:
        """Keep `assignment`, the result of validating `source`, which is the content of the files at `path`."""
        file = self._file(path)
        draft = file.with_name(f"{file.name}.{os.getpid()}")  # renamed when whole: others may read meanwhile
        with suppress(OSError):
            entry: dict[str, Any] = {
                "key": self._digest(path, source),
                "assignment": assignment,
            }
            self._folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            draft.write_text(json.dumps(entry, default=to_plain), encoding="utf-8")
            draft.replace(file)

    def _file(self, path: Path) -> Path:
        place = hashlib.sha256(os.fsencode(path.resolve())).hexdigest()[:16]
        return self._folder / f"{path.parent.name}-{place}.json"

    def _key(self, path: Path) -> str:
        return self._digest(path, content(path))

    def _digest(self, path: Path, source: bytes) -> str:
        digest = self._code.copy()
        digest.update(f"{path.parent.name}\0".encode())  # validated as well: it must be the assignment's id
        digest.update(source)
        return digest.hexdigest()

    @cached_property
    def _code(self) -> "hashlib._Hash":
        """Digest of everything that decides what a valid file means."""
        digest = hashlib.sha256(f"{__version__}\0".encode())
        for path in _VALIDATORS:
            digest.update(path.read_bytes())
        return digest
