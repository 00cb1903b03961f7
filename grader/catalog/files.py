"""The files that say what an assignment is: ``assignment.yaml``, its own interfaces, what its solution drives."""

from pathlib import Path
from typing import Final

SPEC_NAME: Final = "assignment.yaml"
INTERFACES: Final = "interfaces"
REFERENCE: Final = "reference.json"
"""What the solution drives, recorded by ``grader assignments validate`` for a path that says so."""
SOLUTION: Final = "solution.py"
_IGNORED_FILES: Final = ("package.xml", "CMakeLists.txt", "README.md")
"""Files at the top of an interface package that are not interfaces."""


def interface_files(folder: Path) -> list[Path]:
    """Return the files of an assignment's own interfaces in order; none where it brings none."""
    root = folder / INTERFACES
    if not root.is_dir():
        return []
    files = [path for path in sorted(root.rglob("*")) if not path.is_dir() and path.name[0] != "."]
    return [path for path in files if path.name not in _IGNORED_FILES or path.parent.parent != root]


def is_there(path: Path) -> bool:
    """Whether an assignment's own file exists; a folder of the same name may stand for a zip."""
    return path.is_file() or (path.suffix == ".zip" and path.with_suffix("").is_dir())


def handed_in(path: Path) -> bytes:
    """Return what would be stored of an assignment's own file, if a student handed it in.

    Raises:
        OSError: it cannot be read.
        RefusedError: it is a zip or folder that holds no package.
    """
    if path.suffix != ".zip":
        return path.read_bytes()
    from grader.formats.packages.bundle import bundled
    from grader.formats.packages.folders import read_folder

    return bundled(path.read_bytes()) if path.is_file() else read_folder(path.with_suffix(""))


def content(spec: Path) -> bytes:
    """Return all that the files of an assignment say; two with equal content are equal.

    `spec` is the one called ``assignment.yaml``.

    Raises OSError: one of the files cannot be read.
    """
    whole = spec.read_bytes()
    recorded = [spec.with_name(name) for name in (REFERENCE, SOLUTION)]
    for path in interface_files(spec.parent) + (recorded if recorded[0].is_file() else []):
        text = path.read_bytes()
        whole += f"\0{path.relative_to(spec.parent)}\0{len(text)}\0".encode() + text
    return whole
