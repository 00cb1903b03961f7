"""The files that say what an assignment is: ``assignment.yaml``, its own interfaces, what its solution drives."""

from pathlib import Path
from typing import Final

SPEC_NAME: Final = "assignment.yaml"
INTERFACES: Final = "interfaces"
REFERENCE: Final = "reference.json"
"""What the solution drives, recorded by ``grader assignments validate`` for a path that says so."""
SOLUTION: Final = "solution.py"
_BESIDE: Final = ("package.xml", "CMakeLists.txt", "README.md")
"""What stands in a package's folder as well and is not read."""


def interface_files(folder: Path) -> list[Path]:
    """Return the files of an assignment's own interfaces in order; none where it brings none."""
    root = folder / INTERFACES
    if not root.is_dir():
        return []
    found = [path for path in sorted(root.rglob("*")) if not path.is_dir() and path.name[0] != "."]
    return [path for path in found if path.name not in _BESIDE or path.parent.parent != root]


def content(spec: Path) -> bytes:
    """Return all that the files say; two assignments with equal content are equal.

    Args:
        spec: the assignment's ``assignment.yaml``.

    Raises:
        OSError: one of the files cannot be read.
    """
    said = spec.read_bytes()
    recorded = [spec.with_name(name) for name in (REFERENCE, SOLUTION)]
    for path in interface_files(spec.parent) + (recorded if recorded[0].is_file() else []):
        text = path.read_bytes()
        said += f"\0{path.relative_to(spec.parent)}\0{len(text)}\0".encode() + text
    return said
