"""The one reader of zips: within bounds, into memory, and nothing but ordinary files with plain names.

Nothing is ever unpacked to a disk. Sizes are counted while reading; those that the archive states about itself are
not believed. What is refused is an `ArchiveError`, which each caller words for those who sent the zip: `zips`
for the packages of students, `grader.grading.examination.zipped` for the assignments of instructors.
"""

import io
import stat
import struct
import unicodedata
import zipfile
import zlib
from collections.abc import Callable, Collection, Mapping, Sequence
from enum import auto

from grader.contracts.python import StrEnum
from grader.contracts.record import Record

MIB = 1024 * 1024
_UTF8_NAME = 0x800
_ENCRYPTED = 0x1
_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
_EPOCH = (1980, 1, 1, 0, 0, 0)
_BROKEN = (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError, ValueError, OverflowError,
           struct.error, IndexError)  # fmt: skip
"""What `zipfile` raises of content that is no zip, or a damaged one."""

_LONGEST_NAME, _DEEPEST_NAME = 1_000, 100  # also of what is left out, which is known only at a path's end
_CHUNK = 65_536
# Of names without the flag for UTF-8: macOS's and Linux's tools, Chinese Windows.
_CODINGS = (
    "utf-8",
    "gb18030",
)
_OTHERS = {b"Rar!": "RAR", b"7z\xbc\xaf": "7z", b"\x1f\x8b": "gzip", b"BZh": "bzip2", b"\xfd7zX": "xz"}


class Fault(StrEnum):
    """Why an archive, or an entry of it, is refused."""

    OTHER_FORMAT = auto()
    NO_ZIP = auto()
    DAMAGED = auto()
    MANY = auto()
    NAME = auto()
    LONG = auto()
    TWICE = auto()
    LINK = auto()
    LOCKED = auto()
    METHOD = auto()
    LARGE_FILE = auto()
    LARGE = auto()
    DENSE = auto()


class ArchiveError(Exception):
    """An archive is refused.

    Attributes:
        fault: why.
        path: of the entry at fault; empty where it is the archive as a whole.
        count: how many files there are, `most` how many there may be, where there are too many.
        format: what the archive is instead, if that is known.
    """

    def __init__(
        self, fault: Fault, path: str = "", *, count: int = 0, most: int = 0, format_: str = ""
    ) -> None:
        super().__init__(fault)
        self.fault = fault
        self.path = path
        self.count, self.most = count, most
        self.format = format_


class ZipBounds(Record):
    """How much a zip may hold, and how strictly its names are read.

    Attributes:
        files: that are kept. names: entries of its directory, kept or not.
        unpacked_bytes: of all files that are kept. file_bytes: of one.
        ratio: of all unpacked bytes to those of the archive, above the first MiB. file_ratio: of one file's, of
            which deflate reaches 1 032.
        name_bytes: of a kept path, in UTF-8. depth: names in one.
        backslashes: whether a backslash in a path is one that some tools of Windows wrote for a slash.
    """

    files: int = 500
    names: int = 20_000
    unpacked_bytes: int = 4 * MIB
    file_bytes: int = 2 * MIB
    ratio: int = 200
    file_ratio: int = 2_000
    name_bytes: int = 200
    depth: int = 16
    backslashes: bool = True


BOUNDS = ZipBounds()


class ZipEntry(Record, kw_only=False):
    """An entry of an archive's directory: its path, with ``/``, and whether it is an ordinary file."""

    path: str
    is_file: bool


Keep = Callable[[Sequence[ZipEntry]], Collection[str]]


def all_files(entries: Sequence[ZipEntry]) -> Collection[str]:
    """Keep every file."""
    return [entry.path for entry in entries]


def read_archive(content: bytes, keep: Keep = all_files, bounds: ZipBounds = BOUNDS) -> dict[str, bytes]:
    """Return the files of a zip by their paths, in order of these.

    Args:
        content: the archive.
        keep: returns which paths are wanted, given all entries that are no folders. The rest is neither unpacked
            nor counted, and may be a link.
        bounds: more is refused.

    Raises:
        ArchiveError: it is no zip, damaged, encrypted, too large or too deep, or holds links or paths that lead
            out of it.
    """
    _require_zip(content)
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            return _read(archive, content, keep, bounds)
    except _BROKEN as error:
        raise ArchiveError(Fault.DAMAGED) from error


def write_archive(files: Mapping[str, bytes], method: int = zipfile.ZIP_STORED) -> bytes:
    """Return files as a zip whose bytes depend on nothing but their paths and contents."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", method) as archive:
        for path in sorted(files):
            entry = zipfile.ZipInfo(path, _EPOCH)
            entry.create_system = 3
            entry.compress_type = method
            entry.external_attr = (stat.S_IFREG | 0o644) << 16
            archive.writestr(entry, files[path])
    return out.getvalue()


def _require_zip(content: bytes) -> None:
    kind = next((kind for head, kind in _OTHERS.items() if content.startswith(head)), None)
    if kind is not None:
        raise ArchiveError(Fault.OTHER_FORMAT, format_=kind)
    if not zipfile.is_zipfile(io.BytesIO(content)):
        raise ArchiveError(Fault.NO_ZIP)


def _read(archive: zipfile.ZipFile, content: bytes, keep: Keep, bounds: ZipBounds) -> dict[str, bytes]:
    infos = archive.infolist()
    if len(infos) > bounds.names:
        raise ArchiveError(Fault.MANY, count=len(infos), most=bounds.names)
    named: dict[str, zipfile.ZipInfo] = {}
    entries = []
    for info in infos:
        path = _path(info, bounds)
        if path and not path.endswith("/"):
            if path in named:
                raise ArchiveError(Fault.TWICE, path)
            named[path] = info
            entries.append(ZipEntry(path, _is_ordinary(info)))
    kept_paths = sorted(keep(entries))
    _check_kept(kept_paths, {entry.path for entry in entries if not entry.is_file}, bounds)
    files: dict[str, bytes] = {}
    most = min(bounds.unpacked_bytes, max(MIB, bounds.ratio * len(content)))
    for path in kept_paths:
        _check_method(named[path], path)
        files[path] = _unpacked(archive, named[path], path, most, bounds)
        most -= len(files[path])
    return files


def _path(info: zipfile.ZipInfo, bounds: ZipBounds) -> str:
    """Return an entry's path, composed (NFC) and with ``/``; a folder's ends in one.

    Raises ArchiveError: it does not stay inside the archive's own tree.
    """
    name = name_in_zip(info)
    if bounds.backslashes:
        name = name.replace("\\", "/")
    name = unicodedata.normalize("NFC", name)
    parts = name.removesuffix("/").split("/")
    while parts and parts[0] == ".":
        parts = parts[1:]
    if not parts:
        return ""
    if len(name) > _LONGEST_NAME or len(parts) > _DEEPEST_NAME:
        raise ArchiveError(Fault.LONG, name)
    wild = any(part in ("", ".", "..") or part.strip() != part for part in parts)
    if wild or "\\" in name or ":" in parts[0] or not name.isprintable():
        raise ArchiveError(Fault.NAME, name)
    return "/".join(parts) + ("/" if name.endswith("/") else "")


def name_in_zip(info: zipfile.ZipInfo) -> str:
    """Return an entry's name as it was packed, in whichever coding: it may be any text.

    `zipfile` takes a name without the flag for UTF-8 for code page 437.
    """
    name = info.orig_filename
    raw = name.encode("cp437", "replace")
    if info.flag_bits & _UTF8_NAME or raw.isascii():
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
        raise ArchiveError(Fault.MANY, count=len(wanted), most=bounds.files)
    paths_by_folded: dict[str, str] = {}
    for path in wanted:
        if len(path.encode("utf-8", "replace")) > bounds.name_bytes or path.count("/") >= bounds.depth:
            raise ArchiveError(Fault.LONG, path)
        if path in special:
            raise ArchiveError(Fault.LINK, path)
        folded = path.casefold()
        if folded in paths_by_folded:
            raise ArchiveError(Fault.TWICE, path)
        paths_by_folded[folded] = path
    for folded, path in paths_by_folded.items():
        if any(folded.startswith(f"{other}/") for other in above(folded) if other in paths_by_folded):
            raise ArchiveError(Fault.TWICE, path)


def above(path: str) -> list[str]:
    """Return the folders that a path is in, outermost first."""
    parts = path.split("/")
    return ["/".join(parts[:end]) for end in range(1, len(parts))]


def _check_method(info: zipfile.ZipInfo, path: str) -> None:
    if info.flag_bits & _ENCRYPTED:
        raise ArchiveError(Fault.LOCKED, path)
    if info.compress_type not in _METHODS:
        raise ArchiveError(Fault.METHOD, path)


def _unpacked(
    archive: zipfile.ZipFile, info: zipfile.ZipInfo, path: str, most: int, bounds: ZipBounds
) -> bytes:
    """Return a file's content of at most `most` bytes, counted while it is read."""
    content = bytearray()
    dense = bounds.file_ratio * max(info.compress_size, 1)
    bound = min(most, bounds.file_bytes, dense)
    with archive.open(info) as packed:
        while chunk := packed.read(min(_CHUNK, bound + 1 - len(content))):
            content += chunk
            if len(content) > bound:
                faults = {dense: Fault.DENSE, most: Fault.LARGE, bounds.file_bytes: Fault.LARGE_FILE}
                raise ArchiveError(faults[bound], path)
    return bytes(content)
