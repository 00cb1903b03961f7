"""Folders as zips: what is taken, and every way in which a zip tries to be something else."""

import io
import os
import stat
import struct
import subprocess
import sys
import zipfile
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import pytest

from grader.catalog import default_root
from grader.contracts.errors import AssignmentError
from grader.formats.packages.bundle import bundled
from grader.grading.examination import zipped
from grader.grading.examination.reading import read_folder
from grader.grading.examination.zipped import packed, unpacked
from tests.fakes.packages import package_files
from tests.fakes.packages import zipped as package_zip

FOLDER = default_root() / "rosclaw"
FILES = {
    str(path.relative_to(FOLDER)): path.read_bytes()
    for path in FOLDER.rglob("*")
    if path.is_file() and "__pycache__" not in path.parts
}
SPEC = b"id: x\n"


def test_a_folder_comes_back_as_it_was() -> None:
    assert any(name.startswith("interfaces/") for name in FILES)
    assert unpacked(packed("rosclaw", FILES)) == FILES
    assert packed("rosclaw", FILES) == packed("rosclaw", dict(reversed(FILES.items())))


def test_what_systems_add_is_passed_over() -> None:
    added = {
        "__MACOSX/a/._x": b"",
        "a/.DS_Store": b"x",
        "a/__pycache__/x.pyc": b"x",
        "a/wrong/Thumbs.db": b"x",
    }
    assert unpacked(zipped_as({"a/assignment.yaml": SPEC, **added})) == {"assignment.yaml": SPEC}
    assert unpacked(zipped_as({"assignment.yaml": SPEC})) == {"assignment.yaml": SPEC}


def zipped_as(files: dict[str, bytes], change: Callable[[zipfile.ZipInfo], None] = lambda _: None) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as made:
        for name, content in files.items():
            entry = zipfile.ZipInfo(name)
            entry.filename = name
            entry.compress_type = zipfile.ZIP_DEFLATED
            if name != "assignment.yaml":
                change(entry)
            made.writestr(entry, content)
    return out.getvalue()


def test_a_directory_that_lies_is_a_damaged_zip() -> None:
    """An entry without a name, and one that begins where no file can: `zipfile` has odd errors for both."""
    nameless = zipped_as({"a/assignment.yaml": SPEC, "x": b""})
    at = nameless.rindex(b"PK\x01\x02")
    nameless = nameless[: at + 28] + b"\0\0\x01\0" + nameless[at + 32 :]
    far = zipped_as({"a/assignment.yaml": SPEC})
    at, end = far.rindex(b"PK\x01\x02"), far.rindex(b"PK\x05\x06")
    extra = struct.pack("<HHQ", 1, 8, 2**63)
    entry = far[at : at + 30] + struct.pack("<H", len(extra)) + far[at + 32 : at + 42] + b"\xff" * 4
    entry += far[at + 46 : end] + extra
    sized = far[end : end + 12] + struct.pack("<I", len(entry)) + far[end + 16 :]
    for content in (nameless, far[:at] + entry + sized):
        with pytest.raises(AssignmentError) as caught:
            unpacked(content)
        assert "zip" in str(caught.value.problems)


def test_a_name_is_a_file_or_a_folder() -> None:
    files = {"a/assignment.yaml": SPEC, "a/interfaces/x": b"", "a/interfaces/x/y": b""}
    with pytest.raises(AssignmentError) as caught:
        unpacked(zipped_as(files))
    assert "a/interfaces/x" in str(caught.value.problems)


def link(entry: zipfile.ZipInfo) -> None:
    entry.external_attr = (stat.S_IFLNK | 0o777) << 16


def packed_by_lzma(entry: zipfile.ZipInfo) -> None:
    entry.compress_type = zipfile.ZIP_LZMA


def with_password(content: bytes) -> bytes:
    """Set the flag of a password on every entry of the directory."""
    at, out = 0, bytearray(content)
    while (at := out.find(b"PK\x01\x02", at)) >= 0:
        out[at + 8] |= 1
        at += 4
    return bytes(out)


def lying_about_size(content: bytes) -> bytes:
    """Let the directory say that the largest file has ten bytes."""
    at, out = content.rfind(b"PK\x01\x02"), bytearray(content)
    out[at + 24 : at + 28] = (10).to_bytes(4, "little")
    return bytes(out)


NOISE = os.urandom(zipped.MAX_FILE_BYTES)
SPECIFIED = {"assignment.yaml": SPEC}
REFUSED = {
    "no zip": (b"hello", "no zip"),
    "cut": (zipped_as(SPECIFIED)[:-30], "no zip"),
    "large": (b"PK\x03\x04" + bytes(zipped.MAX_ZIP_BYTES), "more than 1024 KiB"),
    "nothing": (zipped_as({}), "no assignment.yaml"),
    "too deep": (zipped_as({"a/b/assignment.yaml": SPEC}), "no assignment.yaml"),
    "above": (zipped_as({**SPECIFIED, "../starter.py": b"x"}), "the name cannot be used"),
    "inside above": (zipped_as({**SPECIFIED, "wrong/../../starter.py": b"x"}), "the name cannot be used"),
    "absolute": (zipped_as({**SPECIFIED, "/etc/passwd": b"x"}), "the name cannot be used"),
    "backslash": (zipped_as({**SPECIFIED, "wrong\\a.py": b"x"}), "the name cannot be used"),
    "drive": (zipped_as({**SPECIFIED, "C:/a.py": b"x"}), "the name cannot be used"),
    "control": (zipped_as({**SPECIFIED, "wrong/a\n.py": b"x"}), "the name cannot be used"),
    "link": (zipped_as({**SPECIFIED, "starter.py": b"/etc/passwd"}, link), "a link or device"),
    "password": (with_password(zipped_as(SPECIFIED)), "has a password"),
    "method": (zipped_as({**SPECIFIED, "starter.py": b"x"}, packed_by_lzma), "unusual way"),
    "bomb": (zipped_as({**SPECIFIED, "starter.py": bytes(zipped.MAX_FILE_BYTES)}), "times smaller"),
    "lies": (lying_about_size(zipped_as({**SPECIFIED, "starter.py": NOISE[:1000]})), "no zip"),
    "large file": (zipped_as({**SPECIFIED, "starter.py": NOISE + b"x"}), "the file has more than 256 KiB"),
    "many": (zipped_as({**SPECIFIED, **{f"wrong/a{n}.py": b"" for n in range(201)}}), "more than 200 files"),
    "very many": (zipped_as({**SPECIFIED, **{f"a{n}/": b"" for n in range(401)}}), "more than 200 files"),
    "twice": (zipped_as({**SPECIFIED, "wrong/a.py": b"", "wrong/A.py": b""}), "two files have this name"),
    "strange": (zipped_as({**SPECIFIED, "evil.so": b"x"}), "no assignment has such a file"),
    "two": (zipped_as({"a/assignment.yaml": SPEC, "b/assignment.yaml": SPEC}), "there are several"),
    "beside": (zipped_as({"a/assignment.yaml": SPEC, "b/starter.py": b"x"}), "no assignment has such a file"),
}


@pytest.mark.parametrize(("content", "told"), REFUSED.values(), ids=REFUSED)
def test_what_is_no_ordinary_folder_is_refused(content: bytes, told: str) -> None:
    with pytest.raises(AssignmentError) as refused:
        unpacked(content)
    assert told in str(refused.value)
    assert refused.value.problems[0][1].zh


PACKAGE = {path: text.encode() for path, text in package_files().items()}


def test_packages_come_as_the_zips_that_are_kept() -> None:
    """As folders, as zips of folders, and zipped with what colcon built: the same bytes."""
    below = {f"a/solution/{path}": text for path, text in PACKAGE.items()}
    starter = package_zip({**PACKAGE, "build/x.py": b"1", "install/x.py": b"2"})
    files = unpacked(
        zipped_as({"a/assignment.yaml": SPEC, **below, "a/starter.zip": starter, "a/wrong/b.zip": starter})
    )
    assert sorted(files) == ["assignment.yaml", "solution.zip", "starter.zip", "wrong/b.zip"]
    assert files["solution.zip"] == files["starter.zip"] == files["wrong/b.zip"] == bundled(starter)
    assert unpacked(packed("a", files)) == files


@pytest.mark.parametrize(
    ("added", "told"),
    [
        ({"solution.zip": b"hello"}, "solution.zip: this is no zip"),
        ({"solution/notes.txt": b"hello"}, "solution/: there is neither a package.xml"),
        ({"wrong/b.zip": package_zip({"a.py": b""})}, "wrong/b.zip: the zip holds a.py, but no package"),
        ({"solution.zip": package_zip(PACKAGE), "solution/setup.py": b""}, "there as a folder, too"),
        (
            {f"wrong/w{i}.zip": package_zip({**PACKAGE, "my_turtle/x": bytes(250_000)}) for i in range(9)},
            "more than 2048 KiB",
        ),
        ({"solution.zip": package_zip({**PACKAGE, "my_turtle/x": bytes(900_000)})}, "unpacks to too much"),
    ],
    ids=["no zip", "no package", "a script", "both", "large together", "large"],
)
def test_what_is_no_package_is_named(added: dict[str, bytes], told: str) -> None:
    with pytest.raises(AssignmentError) as refused:
        unpacked(zipped_as({"assignment.yaml": SPEC, **added}))
    assert told in str(refused.value)


def test_reading_says_file_line_and_field() -> None:
    spec = FILES["assignment.yaml"].replace(b"    points:", b"    pionts:", 1)
    line = spec.decode().split("pionts")[0].count("\n") + 1
    reading = read_folder({**FILES, "assignment.yaml": spec})
    assert reading.assignment is None
    told = {(one.file, one.field): one for one in reading.misfits}
    assert told["assignment.yaml", "items.0.pionts"].line == line


def test_reading_has_bounds() -> None:
    """Aliases of aliases: 9 to the power of 9 texts where somebody takes them apart."""
    names = "abcdefghij"
    bomb = "id: x\nbrief: &a [x,x,x,x,x,x,x,x,x]\n" + "".join(
        f"{after}: &{after} [{','.join([f'*{before}'] * 9)}]\n" for before, after in pairwise(names)
    )
    fields = "title: {zh: *j, en: *j}\nitems: *j\nhorizon_s: *j\n"
    reading = read_folder({"assignment.yaml": f"{bomb}{fields}".encode()})
    assert reading.assignment is None
    assert 0 < len(reading.misfits) <= 50


def test_the_process_that_reads_cannot_do_anything_else(tmp_path: Path) -> None:
    folder = tmp_path / "upload" / "x"
    folder.mkdir(parents=True)
    (folder / "a").write_text("a")
    (tmp_path / "secret").write_text("s")
    tries = f"""
import sys
from pathlib import Path
from grader.grading.examination.confined import _confine
from grader.jail import landlock
_confine(Path({str(folder)!r}))
assert Path({str(folder / "a")!r}).read_text() == "a"
secret, made = Path({str(tmp_path / "secret")!r}), Path({str(folder / "b")!r})
for what in (secret.read_text, lambda: made.write_text("b"), lambda: bytearray(3 * 2**30)):
    try:
        what()
    except (OSError, MemoryError):
        continue
    sys.exit(1 if landlock.abi_version() else 0)
"""
    assert subprocess.run([sys.executable, "-c", tries], check=False).returncode == 0
