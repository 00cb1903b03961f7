"""An assignment's folder as a zip: unpacked in memory within bounds, packed the same way each time.

Nothing is written under a name that came with the zip. Whatever is odd about one is refused by the file's name.
Packages among its files, as folders or as zips, become zips of the one form in which packages are kept.
"""

import re
import zipfile
from collections.abc import Collection, Mapping, Sequence
from pathlib import PurePosixPath
from typing import Final

from grader.catalog.files import SPEC_NAME
from grader.catalog.misfits import refusals
from grader.contracts.errors import RefusedError
from grader.contracts.text import Text
from grader.formats.packages.archives import (
    ArchiveError,
    Fault,
    ZipBounds,
    ZipEntry,
    read_archive,
    write_archive,
)
from grader.formats.packages.bundle import bundle_of, bundled

MAX_ZIP_BYTES: Final = 1024 * 1024
MAX_FILES: Final = 200
MAX_FILE_BYTES: Final = 256 * 1024
MAX_BYTES: Final = 2 * 1024 * 1024
MAX_RATIO: Final = 100
"""Most bytes that one packed byte may stand for; sources have three to ten."""

_LONGEST = 200
_DEPTH = 10
_PASSED_OVER = re.compile(r"(^|/)(__MACOSX|__pycache__|\.[^/]+)(/|$)|\.pyc$|(^|/)(Thumbs\.db|desktop\.ini)$")
_OWN = re.compile(
    r"assignment\.yaml|reference\.json|README(\.zh)?\.md|(starter|solution)\.(py|txt|md|zip)"
    r"|wrong/[A-Za-z0-9_]+\.(py|txt|md|zip)|interfaces/[A-Za-z0-9_./]+"
)
_IN_PACKAGE = re.compile(r"(starter|solution|wrong/[A-Za-z0-9_]+)/.+")
_BOUNDS = ZipBounds(
    files=MAX_FILES,
    names=2 * MAX_FILES,  # folders have entries of their own
    unpacked_bytes=MAX_BYTES,
    file_bytes=MAX_FILE_BYTES,
    ratio=MAX_BYTES,  # each file's counts
    file_ratio=MAX_RATIO,
    name_bytes=_LONGEST,
    depth=_DEPTH + 1,
    backslashes=False,
)
_BOUNDS_OF_PACKAGE = ZipBounds(files=MAX_FILES, unpacked_bytes=MAX_BYTES, file_bytes=MAX_FILE_BYTES)

_NO_ZIP = Text(
    zh="这不是 zip 文件，或者已经损坏：请重新打包", en="this is no zip, or it is damaged; pack it again"
)
_TOO_LARGE = Text(
    zh=f"zip 超过 {MAX_ZIP_BYTES // 1024} KiB：只打包作业自己的文件",
    en=f"the zip has more than {MAX_ZIP_BYTES // 1024} KiB; pack the assignment's own files only",
)
_MANY = Text(zh=f"文件超过 {MAX_FILES} 个：删掉不用的", en=f"more than {MAX_FILES} files; remove unused ones")
_LARGE_FILE = Text(
    zh=f"文件超过 {MAX_FILE_BYTES // 1024} KiB：缩短",
    en=f"the file has more than {MAX_FILE_BYTES // 1024} KiB; shorten it",
)
_LARGE = Text(
    zh=f"解开后超过 {MAX_BYTES // 1024} KiB：删掉不用的文件",
    en=f"unpacked there are more than {MAX_BYTES // 1024} KiB; remove unused files",
)
_DENSE = Text(
    zh=f"压缩超过 {MAX_RATIO} 倍：这不像源文件，请去掉",
    en=f"packed more than {MAX_RATIO} times smaller, as no source is; remove it",
)
_NAME = Text(
    zh="文件名不能用：不要绝对路径、..、反斜杠和控制字符",
    en="the name cannot be used: no absolute path, no .., no backslash, no control characters",
)
_LONG = Text(
    zh=f"路径太长或太深：最多 {_LONGEST} 字节、{_DEPTH} 层文件夹",
    en=f"the path is too long or too deep; at most {_LONGEST} bytes and {_DEPTH} folders",
)
_LINK = Text(
    zh="这是链接或设备，不是文件：放文件本身", en="this is a link or device; put the file itself there"
)
_LOCKED = Text(zh="文件加了密码：请不加密打包", en="the file has a password; pack it without")
_PACKED = Text(zh="压缩方式不认识：请用普通 zip 打包", en="packed in an unusual way; use an ordinary zip")
_TWICE = Text(zh="同名文件有两个：删掉一个", en="two files have this name; remove one")
_STRANGE = Text(
    zh="作业文件夹里没有这种文件：只放 assignment.yaml、starter、solution、wrong/ 和 interfaces/",
    en="no assignment has such a file; pack assignment.yaml, starter, solution, wrong/ and interfaces/ only",
)
_BOTH = Text(
    zh="这个功能包既有文件夹又有 zip：留一个",
    en="this package is there as a folder, too; keep one of them",
)
_NO_SPEC = Text(
    zh="没有 assignment.yaml：打包作业的整个文件夹",
    en="there is no assignment.yaml; pack the assignment's folder",
)
_SEVERAL = Text(
    zh="有多个 assignment.yaml：每个作业单独打包",
    en="there are several; pack each assignment's folder by itself",
)
_FAULT_TEXTS: Final = {
    Fault.MANY: _MANY,
    Fault.NAME: _NAME,
    Fault.LONG: _LONG,
    Fault.TWICE: _TWICE,
    Fault.LINK: _LINK,
    Fault.LOCKED: _LOCKED,
    Fault.METHOD: _PACKED,
    Fault.LARGE_FILE: _LARGE_FILE,
    Fault.LARGE: _LARGE,
    Fault.DENSE: _DENSE,
}


def unpacked(content: bytes) -> dict[str, bytes]:
    """Return the files of a zipped folder by their paths in it.

    A single folder around them is taken off, and what systems and editors add is passed over. A folder that is a
    package, such as ``solution/``, comes as ``solution.zip``.

    Raises AssignmentError: it is no zip, or something in it is out of bounds; names the file.
    """
    if len(content) > MAX_ZIP_BYTES:
        raise refusals([("zip", _TOO_LARGE)])
    try:
        files = read_archive(content, _kept_paths, _BOUNDS)
    except ArchiveError as error:
        whole = not error.path or error.fault is Fault.LARGE
        raise refusals(
            [("zip" if whole else _safe(error.path), _FAULT_TEXTS.get(error.fault, _NO_ZIP))]
        ) from None
    return _with_packages(_without_folder(files))


def packed(folder: str, files: Mapping[str, bytes]) -> bytes:
    """Return a zip of a folder; the same files give the same bytes."""
    below = {f"{folder}/{name}": content for name, content in files.items()}
    return write_archive(below, zipfile.ZIP_DEFLATED)


def _kept_paths(entries: Sequence[ZipEntry]) -> Collection[str]:
    return [entry.path for entry in entries if not _PASSED_OVER.search(entry.path)]


def _without_folder(files: dict[str, bytes]) -> dict[str, bytes]:
    """Return the files seen from the folder that has the specification."""
    specs = {name: name.count("/") for name in files if PurePosixPath(name).name == SPEC_NAME}
    depth = min(specs.values(), default=None)
    highest = [name for name in specs if specs[name] == depth]
    if depth is None or depth > 1:
        raise refusals([(SPEC_NAME, _NO_SPEC)])
    if len(highest) > 1:
        raise refusals([(SPEC_NAME, _SEVERAL)])
    root = highest[0].removesuffix(SPEC_NAME)
    strange = [
        (_safe(name), _STRANGE)
        for name in sorted(files)
        if not name.startswith(root) or not _is_own(name.removeprefix(root))
    ]
    if strange:
        raise refusals(strange[:MAX_FILES])
    return {name.removeprefix(root): content for name, content in files.items()}


def _is_own(name: str) -> bool:
    return bool(_OWN.fullmatch(name) or _IN_PACKAGE.fullmatch(name))


def _with_packages(files: Mapping[str, bytes]) -> dict[str, bytes]:
    """Return the files with each package as a zip of its kept form."""
    packages: dict[str, bytes | dict[str, bytes]] = {}
    packed: dict[str, bytes] = {}
    for name, content in sorted(files.items()):
        if inside := _IN_PACKAGE.fullmatch(name):
            below = packages.setdefault(f"{inside[1]}.zip", {})
            if isinstance(below, bytes):
                raise refusals([(f"{inside[1]}.zip", _BOTH)])
            below[name] = content
        elif name.endswith(".zip"):
            packages[name] = content
        else:
            packed[name] = content
    left = MAX_BYTES - sum(map(len, packed.values()))
    for name, package in packages.items():
        packed[name] = _kept(name, package)
        left -= len(packed[name])
        if left < 0:
            raise refusals([("zip", _LARGE)])
    return dict(sorted(packed.items()))


def _kept(name: str, content: bytes | Mapping[str, bytes]) -> bytes:
    place = name if isinstance(content, bytes) else f"{name.removesuffix('.zip')}/"
    try:
        return bundled(content, _BOUNDS_OF_PACKAGE) if isinstance(content, bytes) else bundle_of(content)
    except RefusedError as error:
        raise refusals([(place, error.text)]) from None


def _safe(name: str) -> str:
    """Return a name as it can be shown, without what separates file, line and field."""
    return "".join(char if char.isprintable() and char != ":" else "?" for char in name)[:_LONGEST] or "?"
