"""Read a zip that somebody uploaded: within bounds, into memory, and nothing but ordinary files with plain names.

Nothing is ever unpacked to a disk. Sizes are counted while reading; those that the archive states about itself are
not believed. What is refused is refused with the sentence that its sender needs.
"""

import io
import stat
import struct
import unicodedata
import zipfile
import zlib
from collections.abc import Callable, Collection, Mapping, Sequence

from grader.contracts.errors import RefusedError
from grader.contracts.record import PositionalRecord, Record
from grader.contracts.text import Text

MIB = 1024 * 1024
_UTF8_NAME = 0x800
_ENCRYPTED = 0x1
_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
BROKEN = (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError, ValueError, OverflowError,
          struct.error, IndexError)  # fmt: skip
"""What `zipfile` raises of content that is no zip, or a damaged one."""

_SHOWN = 80
_LONGEST_NAME, _DEEPEST_NAME = 1_000, 100  # also of what is left out, which is known only at a path's end
_CHUNK = 65_536
_CODINGS = (
    "utf-8",
    "gb18030",
)  # of names without the flag for UTF-8: macOS's and Linux's tools, Chinese Windows
_OTHERS = {b"Rar!": "RAR", b"7z\xbc\xaf": "7z", b"\x1f\x8b": "gzip", b"BZh": "bzip2", b"\xfd7zX": "xz"}


class ZipBounds(Record):
    """How much a zip may hold.

    Attributes:
        files: that are kept. names: entries of its directory, kept or not.
        unpacked_bytes: of all files that are kept. file_bytes: of one. ratio: unpacked to packed size.
        name_bytes: of a kept path, in UTF-8. depth: names in one.
    """

    files: int = 500
    names: int = 20_000
    unpacked_bytes: int = 4 * MIB
    file_bytes: int = 2 * MIB
    ratio: int = 200
    name_bytes: int = 200
    depth: int = 16


BOUNDS = ZipBounds()


class ZipEntry(PositionalRecord):
    """An entry of an archive's directory: its path, with ``/``, and whether it is an ordinary file."""

    path: str
    is_file: bool


Keep = Callable[[Sequence[ZipEntry]], Collection[str]]


def _all_files(entries: Sequence[ZipEntry]) -> Collection[str]:
    return [entry.path for entry in entries]


def read_zip(content: bytes, keep: Keep = _all_files, bounds: ZipBounds = BOUNDS) -> dict[str, bytes]:
    """Return the files of a zip by their paths, in order of these.

    Args:
        content: the archive.
        keep: returns which paths are wanted, given all entries that are no folders. The rest is neither unpacked
            nor counted, and may be a link.
        bounds: more is refused.

    Raises:
        RefusedError: ``bad_archive``: it is no zip, damaged, encrypted, too large or too deep, or holds links or
            paths that lead out of it; ``too_large``: it unpacks to more than the bounds.
    """
    _require_zip(content)
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            return _read(archive, content, keep, bounds)
    except BROKEN as error:
        raise _refusal(
            zh="这个 zip 文件坏了，打不开：请重新压缩后再交。",
            en="this zip is damaged and cannot be read: zip it again",
        ) from error


def write_zip(files: Mapping[str, bytes]) -> bytes:
    """Return files as a zip whose bytes depend on nothing but their paths and contents."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_STORED) as archive:
        for path in sorted(files):
            entry = zipfile.ZipInfo(path, (1980, 1, 1, 0, 0, 0))
            entry.create_system = 3
            entry.external_attr = (stat.S_IFREG | 0o644) << 16
            archive.writestr(entry, files[path])
    return out.getvalue()


def _require_zip(content: bytes) -> None:
    kind = next((kind for head, kind in _OTHERS.items() if content.startswith(head)), None)
    if kind is not None:
        raise _refusal(
            zh=f"这是 {kind} 压缩包，改名字没有用：请压缩成 zip 格式再交。",
            en=f"this is a {kind} archive, whatever its name ends in: pack it as .zip",
        )
    if not zipfile.is_zipfile(io.BytesIO(content)):
        raise _refusal(
            zh="这不是 zip 文件，或者没有传完整：请把文件夹压缩成 .zip 再交。",
            en="this is no zip, or a part of one: pack the folder as .zip and hand that in",
        )


def _read(archive: zipfile.ZipFile, content: bytes, keep: Keep, bounds: ZipBounds) -> dict[str, bytes]:
    infos = archive.infolist()
    if len(infos) > bounds.names:
        raise _too_many(len(infos), bounds.names)
    named: dict[str, zipfile.ZipInfo] = {}
    entries = []
    for info in infos:
        path = _path(info)
        if path and not path.endswith("/"):
            if path in named:
                raise _twice(path)
            named[path] = info
            entries.append(ZipEntry(path, _is_ordinary(info)))
    wanted = sorted(keep(entries))
    _check_kept(wanted, {entry.path for entry in entries if not entry.is_file}, bounds)
    files: dict[str, bytes] = {}
    most = min(bounds.unpacked_bytes, max(MIB, bounds.ratio * len(content)))
    for path in wanted:
        _check_method(named[path], path)
        files[path] = _unpacked(archive, named[path], path, min(most, bounds.file_bytes))
        most -= len(files[path])
    return files


def _path(info: zipfile.ZipInfo) -> str:
    """Return an entry's path, composed (NFC) and with ``/``; a folder's ends in one.

    Raises:
        RefusedError: it does not stay inside the archive's own tree.
    """
    name = info.orig_filename
    if not info.flag_bits & _UTF8_NAME:
        name = _decoded(name)
    name = unicodedata.normalize("NFC", name.replace("\\", "/"))
    parts = name.removesuffix("/").split("/")
    while parts and parts[0] == ".":
        parts = parts[1:]
    if not parts:
        return ""
    if len(name) > _LONGEST_NAME or len(parts) > _DEEPEST_NAME:
        raise _too_long(name)
    wild = any(part in ("", ".", "..") or part.strip() != part for part in parts)
    if wild or ":" in parts[0] or not name.isprintable():
        raise _refusal(
            zh=f"压缩包里有不能用的文件名 {_shown(name)}："
            "把文件夹重新压缩一次，文件名里不要有 ..、开头的 / 或盘符。",
            en=f"the zip holds a name that cannot be used, {_shown(name)}: zip the folder again, without '..', "
            "a leading '/' or a drive letter in any name",
        )
    return "/".join(parts) + ("/" if name.endswith("/") else "")


def _decoded(name: str) -> str:
    """Return a name without the flag for UTF-8: `zipfile` takes it for code page 437."""
    raw = name.encode("cp437", "replace")
    if raw.isascii():
        return name
    for coding in _CODINGS:
        try:
            return raw.decode(coding)
        except UnicodeDecodeError:
            continue
    return name


def _is_ordinary(info: zipfile.ZipInfo) -> bool:
    kind = stat.S_IFMT(info.external_attr >> 16)
    return kind in (0, stat.S_IFREG)


def _check_kept(wanted: Sequence[str], special: Collection[str], bounds: ZipBounds) -> None:
    """Refuse too many files, links and devices, and names that some computers cannot tell apart."""
    if len(wanted) > bounds.files:
        raise _too_many(len(wanted), bounds.files)
    seen: dict[str, str] = {}
    for path in wanted:
        if len(path.encode("utf-8", "replace")) > bounds.name_bytes or path.count("/") >= bounds.depth:
            raise _too_long(path)
        if path in special:
            raise _refusal(
                zh=f"压缩包里的 {_shown(path)} 是链接，不是文件：请换成文件本身。",
                en=f"{_shown(path)} in the zip is a link, not a file: put the file itself there",
            )
        folded = path.casefold()
        if folded in seen:
            raise _twice(path)
        seen[folded] = path
    for folded, path in seen.items():
        if any(folded.startswith(f"{other}/") for other in above(folded) if other in seen):
            raise _twice(path)


def above(path: str) -> list[str]:
    """Return the folders that a path is in, outermost first."""
    parts = path.split("/")
    return ["/".join(parts[:end]) for end in range(1, len(parts))]


def _check_method(info: zipfile.ZipInfo, path: str) -> None:
    if info.flag_bits & _ENCRYPTED:
        raise _refusal(
            zh="这个压缩包有密码：请不设密码重新压缩。",
            en="this zip is protected by a password: zip it again without one",
        )
    if info.compress_type not in _METHODS:
        raise _refusal(
            zh=f"{_shown(path)} 用了少见的压缩方法：请用系统自带的“压缩为 zip”重新压缩。",
            en=f"{_shown(path)} is packed by an unusual method: zip the folder with your system's own tool",
        )


def _unpacked(archive: zipfile.ZipFile, info: zipfile.ZipInfo, path: str, most: int) -> bytes:
    """Return a file's content of at most `most` bytes, counted while it is read."""
    content = bytearray()
    with archive.open(info) as packed:
        while chunk := packed.read(min(_CHUNK, most + 1 - len(content))):
            content += chunk
            if len(content) > most:
                raise RefusedError(
                    "too_large",
                    Text(
                        zh=f"解压后太大（到 {_shown(path)} 为止）：只压缩源代码，"
                        "不要 build、install、log、.git、图片和录像。",
                        en=f"it unpacks to too much (at {_shown(path)}): zip the sources only, without build, "
                        "install, log, .git, pictures and recordings",
                    ),
                    field="file",
                )
    return bytes(content)


def _too_many(count: int, most: int) -> RefusedError:
    return _refusal(
        zh=f"压缩包里有 {count} 个文件，最多 {most} 个：只压缩功能包的文件夹。",
        en=f"the zip holds {count} files, at most {most} are taken: zip nothing but the package's folder",
    )


def _too_long(path: str) -> RefusedError:
    return _refusal(
        zh=f"压缩包里的路径太长：{_shown(path)}。请只压缩功能包的文件夹。",
        en=f"a path in the zip is too long: {_shown(path)}. Zip nothing but the package's folder",
    )


def _twice(path: str) -> RefusedError:
    return _refusal(
        zh=f"压缩包里有两个同名文件（大小写不算）：{_shown(path)}。请改掉一个再压缩。",
        en=f"two files in the zip have the same name but for small and capital letters: {_shown(path)}. "
        "Rename one and zip again",
    )


def _shown(path: str) -> str:
    """Return a path as it may be printed."""
    text = path if len(path) <= _SHOWN else f"…{path[-_SHOWN:]}"
    return "".join(char if char.isprintable() else "?" for char in text)


def _refusal(*, zh: str, en: str) -> RefusedError:
    return RefusedError("bad_archive", Text(zh=zh, en=en), field="file")
