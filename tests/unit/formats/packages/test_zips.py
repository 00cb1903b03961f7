"""Zips that would do harm, or that nobody could read, are refused with a sentence; others are read as they are."""

import io
import resource
import stat
import struct
import warnings
import zipfile
import zlib
from collections.abc import Callable

import pytest

from grader.contracts.errors import RefusedError
from grader.formats.packages.archives import BOUNDS, ZipBounds, write_archive
from grader.formats.packages.bundle import bundled, files_of
from grader.formats.packages.zips import read_zip
from tests.fakes.packages import NAME, package_files, zipped

FILES = package_files()
INSIDE = f"{NAME}/{NAME}/x.py"


def _with(*extra: tuple[str, bytes]) -> bytes:
    """Return the right package with more entries, whose names are written as they are."""
    out = io.BytesIO(zipped(FILES))
    with warnings.catch_warnings(), zipfile.ZipFile(out, "a", zipfile.ZIP_DEFLATED) as archive:
        warnings.simplefilter("ignore")  # the same name twice is what some are about
        for name, content in extra:
            info = zipfile.ZipInfo("x")
            info.filename = info.orig_filename = name
            archive.writestr(info, content)
    return out.getvalue()


def _special(kind: int, target: bytes = b"/etc/passwd") -> bytes:
    out = io.BytesIO(zipped(FILES))
    with zipfile.ZipFile(out, "a") as archive:
        info = zipfile.ZipInfo(INSIDE)
        info.create_system = 3
        info.external_attr = (kind | 0o777) << 16
        archive.writestr(info, target)
    return out.getvalue()


def _patched(content: bytes, offset: int, value: bytes, *, signature: bytes = b"PK\x01\x02") -> bytes:
    """Return an archive with bytes of the last header of a kind replaced."""
    at = content.rindex(signature) + offset
    return content[:at] + value + content[at + len(value) :]


def _raw(name: bytes) -> bytes:
    """Return the right package with one more entry of this name, without the flag for UTF-8."""
    content = _with(("q" * len(name), b"x = 1\n"))
    return content.replace(b"q" * len(name), name)


def _overlapping() -> bytes:
    """Return an archive of 400 entries that all are the same bytes (as in Fifield's bomb)."""
    one = io.BytesIO()
    with zipfile.ZipFile(one, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(f"{NAME}/package.xml", b"\0" * 2_000_000)
        info = archive.infolist()[0]
        for number in range(400):
            copy = zipfile.ZipInfo(f"{NAME}/{number:07}.xml")
            copy.header_offset, copy.CRC, copy.compress_type = 0, info.CRC, info.compress_type
            copy.compress_size, copy.file_size = info.compress_size, info.file_size
            archive.filelist.append(copy)
            archive.NameToInfo[copy.filename] = copy
        archive._didModify = True  # type: ignore[attr-defined]
    return one.getvalue()


def _quine_like() -> bytes:
    inner = zipped({"r.zip": zipped({"r.zip": zipped({"r.zip": b"PK\x03\x04"})})})
    return zipped({"r.zip": inner})


def _many(count: int) -> bytes:
    return zipped({**FILES, **{f"{NAME}/n/{number}.py": "" for number in range(count)}}, zipfile.ZIP_STORED)


def _size_lies(size: int) -> bytes:
    """Return an archive whose directory and header state another size than a file unpacks to."""
    content = _with((INSIDE, b"x" * 100_000))
    field = struct.pack("<I", size)
    return _patched(_patched(content, 24, field), 22, field, signature=b"PK\x03\x04")


REFUSED: dict[str, Callable[[], bytes]] = {
    "empty": lambda: b"",
    "text": lambda: b"print(1)\n",
    "no zip at all": lambda: b"PK\x03\x04" + b"\0" * 100,
    "only the end": lambda: b"PK\x05\x06" + b"\0" * 18,
    "cut in half": lambda: zipped(FILES)[:500],
    "without its directory": lambda: zipped(FILES)[:-60],
    "first half of a directory": lambda: zipped(FILES)[300:],
    "rar": lambda: b"Rar!\x1a\x07\x00" + b"\0" * 100,
    "7z": lambda: b"7z\xbc\xaf\x27\x1c" + b"\0" * 100,
    "gzip": lambda: b"\x1f\x8b\x08" + b"\0" * 100,
    "bzip2": lambda: b"BZh91AY" + b"\0" * 100,
    "xz": lambda: b"\xfd7zXZ\x00" + b"\0" * 100,
    "up and out": lambda: _with(("../evil.py", b"x")),
    "up and out, deep": lambda: _with((f"{NAME}/../../../etc/cron.d/x", b"x")),
    "up and out with \\": lambda: _with((f"{NAME}\\..\\..\\evil.py", b"x")),
    "dots only": lambda: _with((f"{NAME}/..", b"x")),
    "a dot inside": lambda: _with((f"{NAME}/./x.py", b"x")),
    "absolute": lambda: _with(("/etc/passwd", b"x")),
    "network path": lambda: _with(("\\\\server\\share\\x.py", b"x")),
    "drive letter": lambda: _with(("C:/evil.py", b"x")),
    "drive letter, relative": lambda: _with(("C:evil.py", b"x")),
    "stream of NTFS": lambda: _with(("x.py:hidden", b"x")),
    "NUL in a name": lambda: _raw(b"my_turtle/a.py\0.txt"),
    "line end in a name": lambda: _with((f"{NAME}/a\nb.py", b"x")),
    "escape in a name": lambda: _with((f"{NAME}/\x1b[31m.py", b"x")),
    "right to left in a name": lambda: _with((f"{NAME}/\u202eyp.x", b"x")),
    "nothing between slashes": lambda: _with((f"{NAME}//x.py", b"x")),
    "space at the end": lambda: _with((f"{NAME}/x.py ", b"x")),
    "space as a folder": lambda: _with((f"{NAME}/ /x.py", b"x")),
    "long name": lambda: _with((f"{NAME}/{'x' * 300}.py", b"x")),
    "long name in Chinese": lambda: _with((f"{NAME}/{'方' * 80}.py", b"x")),
    "deep": lambda: _with((f"{NAME}/{'d/' * 40}x.py", b"x")),
    "link": lambda: _special(stat.S_IFLNK),
    "device": lambda: _special(stat.S_IFCHR),
    "pipe": lambda: _special(stat.S_IFIFO),
    "socket": lambda: _special(stat.S_IFSOCK),
    "the same name twice": lambda: _with((INSIDE, b"a"), (INSIDE, b"b")),
    "the same name but for capitals": lambda: _with((INSIDE, b"a"), (INSIDE.replace("x.py", "X.py"), b"b")),
    "the same name but for composition": lambda: _with(
        (f"{NAME}/\u00e9.py", b"a"), (f"{NAME}/e\u0301.py", b"b")
    ),
    "a file that is a folder": lambda: _with((f"{NAME}/d", b"a"), (f"{NAME}/d/x.py", b"b")),
    "a manifest twice": lambda: _with((f"{NAME}/package.xml", b"<package/>")),
    "password": lambda: _patched(zipped(FILES), 8, b"\x01\x00"),
    "LZMA": lambda: zipped(FILES, zipfile.ZIP_LZMA),
    "BZIP2": lambda: zipped(FILES, zipfile.ZIP_BZIP2),
    "unknown method": lambda: _patched(zipped(FILES), 10, b"\x63\x00"),
    "bomb": lambda: zipped({**FILES, f"{NAME}/x.yaml": b"\0" * 100_000_000}),
    "bomb of many": lambda: zipped({**FILES, **{f"{NAME}/{i}.yaml": b"\0" * 1_900_000 for i in range(60)}}),
    "overlapping": _overlapping,
    "501 files": lambda: _many(501),
    "a path of 64 KiB that is left out": lambda: _raw(b"build/" + b"x" * 65_000),
    "a path of 101 names that is left out": lambda: _raw(b"build/" + b"x/" * 99 + b"y"),
    "20 001 files": lambda: _many(20_001),
    "zip in zip in zip": _quine_like,
    "bomb in a zip": lambda: zipped({"x.zip": zipped({f"{NAME}/package.xml": b"\0" * 50_000_000})}),
    "inner zip with a way out": lambda: zipped({"x.zip": _with(("../evil.py", b"x"))}),
    "damaged content": lambda: zipped(FILES).replace(zlib.compress(b"")[:1], b"\xff", 3),
    "wrong checksum": lambda: _patched(zipped(FILES), 16, b"\1\2\3\4"),
    "other name in the header": lambda: zipped(FILES).replace(
        b"my_turtle/setup.cfg", b"my_turtle/setup.cfh", 1
    ),
    "offset beyond the end": lambda: _patched(zipped(FILES), 42, b"\xff\xff\xff\x7f"),
    "more than it says": lambda: _size_lies(10),
    "newer version needed": lambda: _patched(zipped(FILES), 6, b"\xff\x00"),
}
HARMLESS: dict[str, Callable[[], bytes]] = {
    "links in install": lambda: _with(("build/COLCON_IGNORE", b""), ("build/x", b"y")),
    "something in front": lambda: b"#!/bin/sh\nrm -rf /\n" + zipped(FILES),
    "a comment": lambda: zipped(FILES)[:-2] + struct.pack("<H", 5) + b"hello",
    "GBK names": lambda: _raw("my_turtle/说明.md".encode("gbk")),
    "UTF-8 names without the flag": lambda: _raw("my_turtle/说明.md".encode()),
    "size that wraps around": lambda: _size_lies(0xFFFFFFFE),
    "less than it says": lambda: _size_lies(0x7FFFFFFF),
    "polyglot": lambda: b"%PDF-1.7\n" + zipped(FILES),
}


def test_there_are_at_least_sixty() -> None:
    assert len(REFUSED) + len(HARMLESS) >= 60


@pytest.mark.parametrize("make", REFUSED.values(), ids=REFUSED.keys())
def test_a_hostile_zip_is_refused_with_a_reason(make: Callable[[], bytes]) -> None:
    with pytest.raises(RefusedError) as caught:
        bundled(make())
    assert caught.value.code in ("bad_archive", "too_large", "no_package")
    assert caught.value.detail is not None
    assert str(caught.value).isprintable()
    assert caught.value.zh.isprintable()


@pytest.mark.parametrize("make", HARMLESS.values(), ids=HARMLESS.keys())
def test_an_unusual_zip_is_read(make: Callable[[], bytes]) -> None:
    kept = files_of(bundled(make()))
    assert {path: text.encode() for path, text in FILES.items()}.items() <= kept.items()


def test_names_of_chinese_windows_are_understood() -> None:
    assert f"{NAME}/说明.md" in files_of(bundled(_raw("my_turtle/说明.md".encode("gbk"))))


def test_what_a_bomb_unpacks_to_is_never_in_memory() -> None:
    bomb = zipped({f"{NAME}/x.yaml": b"\0" * 300_000_000, f"{NAME}/package.xml": b""})
    before_kib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(RefusedError, match="unpacks to too much"):
        bundled(bomb)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before_kib < 64 * 1024


def test_what_is_not_wanted_is_neither_counted_nor_unpacked() -> None:
    content = zipped({"a": "1", "b": b"\0" * 5_000_000, "c": "2"})
    assert read_zip(content, lambda entries: [each.path for each in entries if each.path != "b"]) == {
        "a": b"1",
        "c": b"2",
    }


def test_bounds_are_the_callers() -> None:
    with pytest.raises(RefusedError, match="3 files, at most 2"):
        read_zip(zipped({"a": "1", "b": "2", "c": "3"}), bounds=ZipBounds(files=2))
    assert BOUNDS.unpacked_bytes == 4 * 1024 * 1024


def test_a_written_zip_is_read_back() -> None:
    assert read_zip(write_archive({"b": b"2", "a": b""})) == {"a": b"", "b": b"2"}
