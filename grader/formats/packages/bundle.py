"""The one form in which a package is kept: the files that are the student's, however the zip was made.

The same files give the same bytes, whatever packed them and whatever lay around them: a workspace's `build`,
`install` and `log`, the traces of editors and systems, the folder that GitHub puts around an archive.
"""

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import takewhile
from typing import Final

from grader.contracts.errors import RefusedError
from grader.contracts.text import Text
from grader.contracts.upload import decoded, lines_of
from grader.formats.packages.archives import BOUNDS, ZipBounds, ZipEntry, above, write_archive
from grader.formats.packages.zips import read_zip

MAX_PACKAGE_BYTES: Final = 1024 * 1024
"""Of a zip as it is handed in."""

_ZIP: Final = b"PK\x03\x04"
MANIFEST: Final = "package.xml"
SETUP: Final = "setup.py"
_IGNORED: Final = ("COLCON_IGNORE", "AMENT_IGNORE")
_COLCON: Final = ("build", "install", "log")
_LEFT_BEHIND: Final = ("__MACOSX", "__pycache__", "Thumbs.db", "desktop.ini", "CVS", "venv", "node_modules")
_LEFT_ENDINGS: Final = (".pyc", ".pyo", ".egg-info", ".swp", "~")
_NAME_IN_MANIFEST: Final = re.compile(rb"<name>\s*([A-Za-z0-9_.-]{1,100})\s*</name>")
_UNNAMED: Final = "package"


def bundled(content: bytes, bounds: ZipBounds = BOUNDS) -> bytes:
    """Return an uploaded zip in the form in which it is kept.

    Raises as `grader.formats.packages.zips.read_zip`, and ``no_package`` where nothing in it is a package.
    """
    files = read_zip(content, _own_or_inner, bounds)
    if len(files) == 1 and next(iter(files)).lower().endswith(".zip"):  # somebody zipped the zip
        files = read_zip(next(iter(files.values())), _own, bounds)
    return bundle_of(files)


def bundle_of(files: Mapping[str, bytes]) -> bytes:
    """Return files below any folder in the form in which a package is kept.

    Raises RefusedError: ``no_package``.
    """
    kept = own_files(files)
    folders = package_folders(kept)
    if not folders:
        raise _no_package(kept)
    base, known = _common(folders), set(folders)
    found = {}
    for path in kept:
        folder = _folder_above(path, known)
        if folder is None:
            continue
        if folder == "":
            found[f"{_name_of(files.get(MANIFEST, b''))}/{path}"] = files[path]
        else:
            found[path[len(base) :]] = files[path]
    return write_archive(found)


def files_of(source: bytes) -> dict[str, bytes]:
    """Return the files of a kept package by their paths, which begin with the package's folder.

    Raises RefusedError: it is none.
    """
    return read_zip(source)


def is_package(source: bytes) -> bool:
    """Whether something that was stored is a package: no script or answer begins like an archive."""
    return source.startswith(_ZIP)


def text_of(source: bytes) -> str:
    """Return what was handed in as one text: of a package each text file under a line with its path."""
    if not is_package(source):
        return decoded(source)
    return "".join(f"{heading(path)}\n{text}" for path, text in texts_of(files_of(source)).items())


def code_of(source: bytes) -> str:
    """Return the code of what was handed in: of a package its modules as `text_of` has them, without setup.py."""
    if not is_package(source):
        return decoded(source)
    texts = texts_of(files_of(source))
    return "".join(f"{heading(path)}\n{text}" for path, text in texts.items() if _is_code(path))


def line_in_text(source: bytes, file: str, line: int) -> int:
    """Return where a line of a file is in `text_of`; of a file that is not a package's, `line` itself."""
    if not is_package(source):
        return line
    before = 0
    for path, text in texts_of(files_of(source)).items():
        if path == file:
            return before + 1 + line
        before += 1 + text.count("\n")
    return line


def heading(path: str) -> str:
    """Return the line above a file in a listing."""
    return f"# ===== {path} ====="


def texts_of(files: Mapping[str, bytes]) -> dict[str, str]:
    """Return the files that are texts, modules first; each ends with a line end."""
    order = sorted(files, key=lambda path: (not path.endswith(".py"), path.endswith(f"/{SETUP}"), path))
    return {
        path: "\n".join((*lines_of(decoded(files[path])), "")) for path in order if b"\0" not in files[path]
    }


def _is_code(path: str) -> bool:
    return path.endswith(".py") and not path.endswith(f"/{SETUP}")


def own_files(paths: Iterable[str]) -> list[str]:
    """Return the paths that somebody wrote: not what colcon built, nor what systems and editors leave behind."""
    every = sorted(paths)
    packages = {path.rpartition("/")[0] for path in every if path.rpartition("/")[2] == MANIFEST}
    ignored = {path.rpartition("/")[0] for path in every if path.rpartition("/")[2] in _IGNORED}
    return [path for path in every if not _is_left_behind(path, packages, ignored)]


def package_folders(paths: Sequence[str]) -> list[str]:
    """Return the outermost folders with a manifest, or if none has one, a ``setup.py``; ``""`` is the top."""
    for name in (MANIFEST, SETUP):
        folders: set[str] = set()
        for path in sorted(paths, key=lambda each: (each.count("/"), each)):
            folder, _, last = path.rpartition("/")
            if last == name and _folder_above(path, folders) is None:
                folders.add(folder)
        if folders:
            return sorted(folders)
    return []


def _own(entries: Sequence[ZipEntry]) -> Collection[str]:
    """Return the paths of all packages in an archive, or all where there is none: somebody will say so."""
    kept = own_files(entry.path for entry in entries)
    folders = set(package_folders(kept))
    return [path for path in kept if _folder_above(path, folders) is not None]


def _own_or_inner(entries: Sequence[ZipEntry]) -> Collection[str]:
    kept = own_files(entry.path for entry in entries)
    zips = [path for path in kept if path.lower().endswith(".zip")]
    if not package_folders(kept):
        return zips if len(zips) == 1 else kept
    return _own(entries)


def _is_left_behind(path: str, packages: Collection[str], ignored: Collection[str]) -> bool:
    """Return whether colcon, a system or an editor made a file. One walk along the path: an upload has many."""
    *folders, last = path.split("/")
    folder, in_package = "", "" in packages
    for part in folders:
        folder = f"{folder}/{part}" if folder else part
        of_workspace = part in _COLCON and not in_package
        if _is_no_source(part) or of_workspace or folder in ignored:
            return True
        in_package = in_package or folder in packages
    return _is_no_source(last) or last in _IGNORED


def _is_no_source(part: str) -> bool:
    return part.startswith(".") or part in _LEFT_BEHIND or part.endswith(_LEFT_ENDINGS)


def _folder_above(path: str, folders: Collection[str]) -> str | None:
    """Return the outermost of `folders`, a set, that has `path` in or below it."""
    return next((folder for folder in ("", *above(path)) if folder in folders), None)


def _common(folders: Sequence[str]) -> str:
    """Return what all folders' paths have in front of their names, with a slash at its end."""
    parents = [folder.split("/")[:-1] for folder in folders]
    shared = [
        names[0] for names in takewhile(lambda names: len(set(names)) == 1, zip(*parents, strict=False))
    ]
    return "".join(f"{name}/" for name in shared)


def _name_of(manifest: bytes) -> str:
    name_element = _NAME_IN_MANIFEST.search(manifest)
    return name_element[1].decode() if name_element else _UNNAMED


def _no_package(paths: Sequence[str]) -> RefusedError:
    scripts = [path for path in paths if path.endswith(".py")]
    if not paths:
        told = Text(
            zh="压缩包里没有可用的文件：把功能包文件夹（里面有 package.xml 和 setup.py）压缩成 zip 再交。",
            en="the zip holds no file of yours: zip the package's folder, the one with package.xml and setup.py",
        )
    elif scripts:
        told = Text(
            zh=f"压缩包里有 {scripts[0]}，但没有功能包：用 ros2 pkg create --build-type ament_python 建一个，"
            "把代码放进去，再压缩整个功能包文件夹（里面有 package.xml 和 setup.py）。",
            en=f"the zip holds {scripts[0]}, but no package: make one with ros2 pkg create --build-type "
            "ament_python, put the code there, and zip the package's whole folder, with package.xml and setup.py",
        )
    else:
        told = Text(
            zh="压缩包里没有 package.xml，也没有 setup.py：压缩整个功能包文件夹再交。",
            en="there is neither a package.xml nor a setup.py in the zip: zip the package's whole folder",
        )
    return RefusedError("no_package", told, field="file")
