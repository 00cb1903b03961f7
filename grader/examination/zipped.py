"""An assignment's folder as a zip: unpacked in memory within bounds, packed the same way each time.

Nothing is written under a name that came with the zip. Whatever is odd about one is refused by the file's name.
"""

import io
import re
import stat
import zipfile
from collections.abc import Iterable, Mapping
from pathlib import PurePosixPath
from typing import Final

from grader.catalog.files import SPEC_NAME
from grader.catalog.misfits import refusals
from grader.contracts.text import Text
from grader.packages.zips import BROKEN, above

MAX_ZIP_BYTES: Final = 1024 * 1024
MAX_FILES: Final = 200
MAX_FILE_BYTES: Final = 256 * 1024
MAX_BYTES: Final = 2 * 1024 * 1024
MAX_RATIO: Final = 100
"""Most bytes that one packed byte may stand for; sources have three to ten."""

_LONGEST = 200
_DEPTH = 5
_PASSED_OVER = re.compile(r"(^|/)(__MACOSX|__pycache__|\.[^/]+)(/|$)|\.pyc$|(^|/)(Thumbs\.db|desktop\.ini)$")
_OWN = re.compile(
    r"assignment\.yaml|reference\.json|README(\.zh)?\.md|(starter|solution)\.(py|txt|md)"
    r"|wrong/[A-Za-z0-9_]+\.(py|txt|md)|interfaces/[A-Za-z0-9_./]+"
)
_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
_EPOCH = (1980, 1, 1, 0, 0, 0)

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
_NO_SPEC = Text(
    zh="没有 assignment.yaml：打包作业的整个文件夹",
    en="there is no assignment.yaml; pack the assignment's folder",
)


def unpacked(content: bytes) -> dict[str, bytes]:
    """Return the files of a zipped folder by their paths in it.

    A single folder around them is taken off, and what systems and editors add is passed over.

    Raises:
        AssignmentError: it is no zip, or something in it is out of bounds; names the file.
    """
    if len(content) > MAX_ZIP_BYTES:
        raise refusals([("zip", _TOO_LARGE)])
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as opened:
            entries = opened.infolist()
            if len(entries) > 2 * MAX_FILES:  # folders have entries of their own
                raise refusals([("zip", _MANY)])
            files = [one for one in entries if not one.is_dir()]
            if wrong := [(_shown(one), told) for one in files if (told := _misfit(one)) is not None]:
                raise refusals(wrong)
            wanted = [one for one in files if not _PASSED_OVER.search(one.filename)]
            if len(wanted) > MAX_FILES:
                raise refusals([("zip", _MANY)])
            found = {one.filename: _read(opened, one) for one in wanted}
    except BROKEN:
        raise refusals([("zip", _NO_ZIP)]) from None
    _check_all(found, len(wanted))
    return _without_folder(found)


def packed(folder: str, files: Mapping[str, bytes]) -> bytes:
    """Return a zip of a folder; the same files give the same bytes."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as made:
        for name, content in sorted(files.items()):
            entry = zipfile.ZipInfo(f"{folder}/{name}", _EPOCH)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (stat.S_IFREG | 0o644) << 16
            made.writestr(entry, content)
    return out.getvalue()


def _misfit(entry: zipfile.ZipInfo) -> Text | None:
    """Return what is wrong with an entry before anything of it is read."""
    kind = stat.S_IFMT(entry.external_attr >> 16)
    unusual = kind not in (0, stat.S_IFREG)
    checks: Iterable[tuple[bool, Text]] = (
        (not _is_plain(entry.filename) or entry.orig_filename.rstrip("\0") != entry.filename, _NAME),
        (unusual, _LINK),
        (bool(entry.flag_bits & 0x1), _LOCKED),
        (entry.compress_type not in _METHODS, _PACKED),
        (entry.file_size > MAX_FILE_BYTES, _LARGE_FILE),
        (entry.file_size > MAX_RATIO * max(entry.compress_size, 1), _DENSE),
    )
    return next((told for holds, told in checks if holds), None)


def _is_plain(name: str) -> bool:
    parts = name.split("/")
    return (
        0 < len(name) <= _LONGEST
        and len(parts) <= _DEPTH + 1
        and all(part not in ("", ".", "..") for part in parts)
        and name.isprintable()
        and "\\" not in name
        and ":" not in name
    )


def _read(opened: zipfile.ZipFile, entry: zipfile.ZipInfo) -> bytes:
    with opened.open(entry) as file:
        content = file.read(MAX_FILE_BYTES + 1)  # whatever size the entry says
    if len(content) > MAX_FILE_BYTES:
        raise refusals([(_shown(entry), _LARGE_FILE)])
    return content


def _check_all(found: Mapping[str, bytes], entries: int) -> None:
    if len(found) != entries or len({name.lower() for name in found}) != entries:
        seen: set[str] = set()
        twice = [name for name in found if name.lower() in seen or seen.add(name.lower())]  # type: ignore[func-returns-value]
        raise refusals([(_safe(twice[0]) if twice else "zip", _TWICE)])
    folders = {one for name in found for one in above(name)}
    if both := folders & found.keys():
        raise refusals([(_safe(min(both)), _TWICE)])
    if sum(map(len, found.values())) > MAX_BYTES:
        raise refusals([("zip", _LARGE)])


def _without_folder(found: dict[str, bytes]) -> dict[str, bytes]:
    """Return the files seen from the folder that has the specification."""
    specs = sorted((name for name in found if PurePosixPath(name).name == SPEC_NAME), key=len)
    if not specs or specs[0].count("/") > 1:
        raise refusals([(SPEC_NAME, _NO_SPEC)])
    root = specs[0].removesuffix(SPEC_NAME)
    strange = [
        (_safe(name), _STRANGE)
        for name in sorted(found)
        if not name.startswith(root) or not _OWN.fullmatch(name.removeprefix(root))
    ]
    if strange:
        raise refusals(strange[:MAX_FILES])
    return {name.removeprefix(root): content for name, content in found.items()}


def _shown(entry: zipfile.ZipInfo) -> str:
    return _safe(entry.filename)


def _safe(name: str) -> str:
    """Return a name as it can be shown, without what separates file, line and field."""
    return "".join(char if char.isprintable() and char != ":" else "?" for char in name)[:_LONGEST] or "?"
