"""The grader's own files, and the wheel that holds them: what a service offers to its students' machines."""

import base64
import hashlib
import io
import zipfile
from collections.abc import Iterator
from functools import cache
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Final

import grader

_STAMP: Final = (2020, 1, 1, 0, 0, 0)  # of all files of a zip: the same parts make the same bytes
_BESIDE: Final = ("assignments", "lesson", "requirements.lock", "docs/student.md", "docs/student.zh.md")
"""What lies beside the package in a source tree, and in the package where it is installed."""

_WHEEL: Final = "Wheel-Version: 1.0\nGenerator: grader\nRoot-Is-Purelib: true\nTag: py3-none-any\n"


def package_files() -> Iterator[tuple[str, Path]]:
    """Yield the name in the package, and the path, of each of the grader's own files, in order."""
    package = Path(grader.__file__).resolve().parent
    beside = [package.parent / name for name in _BESIDE if not (package / name).exists()]
    for root, top in [(package, package), *((package.parent, path) for path in beside)]:
        for path in sorted(top.rglob("*")) if top.is_dir() else [top]:
            parts = path.relative_to(root).parts
            if path.is_file() and "__pycache__" not in parts:
                yield "/".join(parts), path


def add_file(archive: zipfile.ZipFile, name: str, content: bytes, *, executable: bool = False) -> None:
    """Add a file to a zip, without anything that differs from one packing to the next."""
    entry = zipfile.ZipInfo(name, _STAMP)
    entry.compress_type = zipfile.ZIP_DEFLATED
    entry.external_attr = (0o100755 if executable else 0o100644) << 16
    archive.writestr(entry, content)


def wheel_name() -> str:
    """Return the file name of the wheel of this version."""
    return f"grader-{grader.__version__}-py3-none-any.whl"


@cache
def wheel() -> bytes | None:
    """Return this installation as a wheel; None where the grader runs without having been installed.

    Its format: packaging.python.org, "Binary distribution format".
    """
    try:
        installed = distribution("grader")
    except PackageNotFoundError:
        return None
    info = f"grader-{grader.__version__}.dist-info"
    about = {
        "METADATA": installed.read_text("METADATA") or "",
        "WHEEL": _WHEEL,
        "entry_points.txt": installed.read_text("entry_points.txt") or "",
    }
    packed = io.BytesIO()
    record = []
    with zipfile.ZipFile(packed, "w") as archive:
        contents = ((f"grader/{name}", path.read_bytes()) for name, path in package_files())
        for name, content in [
            *contents,
            *((f"{info}/{name}", text.encode()) for name, text in about.items()),
        ]:
            add_file(archive, name, content)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            record.append(f'"{name}",sha256={digest},{len(content)}\n')
        add_file(archive, f"{info}/RECORD", "".join([*record, f"{info}/RECORD,,\n"]).encode())
    return packed.getvalue()
