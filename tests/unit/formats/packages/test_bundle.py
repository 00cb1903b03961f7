"""Whatever a package was zipped with, and whatever lay around it: the same files are kept as the same bytes."""

import time
import zipfile
from pathlib import Path

import pytest

from grader.contracts.errors import RefusedError
from grader.formats.packages.bundle import (
    bundled,
    code_of,
    files_of,
    line_in_text,
    own_files,
    package_folders,
    text_of,
)
from grader.formats.packages.folders import read_folder
from tests.fakes.packages import NAME, below, package_files, zipped

FILES = package_files()
KEPT = bundled(zipped(FILES))
LEFT_BEHIND = {
    "__MACOSX/._my_turtle": "x",
    "my_turtle/.DS_Store": "x",
    "my_turtle/.git/config": "x",
    "my_turtle/my_turtle/__pycache__/drive.cpython-310.pyc": "x",
    "my_turtle/my_turtle.egg-info/PKG-INFO": "x",
}
WORKSPACE = {
    "ws/build/COLCON_IGNORE": "",
    "ws/build/my_turtle/setup.py": "x",
    "ws/install/my_turtle/share/my_turtle/package.xml": "<package/>",
    "ws/log/latest_build/events.log": "x",
    "ws/README.md": "x",
}


@pytest.mark.parametrize(
    "content",
    [
        zipped(FILES, zipfile.ZIP_STORED),
        zipped(dict(reversed(FILES.items()))),
        zipped({**FILES, **LEFT_BEHIND}),
        zipped({path.removeprefix(f"{NAME}/"): text for path, text in FILES.items()}),
        zipped({**below("ws/src", FILES), **WORKSPACE}),
        zipped(below("turtle-homework-main", FILES)),
        zipped({"homework.zip": zipped(FILES)}),
        zipped({path.replace("/", "\\"): text for path, text in FILES.items()}),
        KEPT,
    ],
    ids=[
        "stored",
        "other order",
        "macOS and git",
        "without folder",
        "workspace",
        "GitHub",
        "zip in zip",
        "\\",
        "kept",
    ],
)
def test_the_same_files_are_the_same_bytes(content: bytes) -> None:
    assert bundled(content) == KEPT


def test_a_folder_is_kept_like_its_zip(tmp_path: Path) -> None:
    for path, text in {**below("ws/src", FILES), **WORKSPACE}.items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(text)
    (tmp_path / "ws/src/my_turtle/link.py").symlink_to("/etc/passwd")
    assert read_folder(tmp_path / "ws/src/my_turtle") == KEPT
    assert read_folder(tmp_path / "ws") == KEPT


def test_a_module_called_like_colcons_folders_stays() -> None:
    assert f"{NAME}/log/note.py" in files_of(bundled(zipped({**FILES, f"{NAME}/log/note.py": "x = 1\n"})))


@pytest.mark.parametrize("files", [{"a.py": "print(1)"}, {"notes.txt": "x"}, {"__MACOSX/x": "y"}])
def test_an_archive_without_a_package_is_refused_with_what_to_do(files: dict[str, str]) -> None:
    with pytest.raises(RefusedError, match=r"package\.xml") as caught:
        bundled(zipped(files))
    assert caught.value.code == "no_package"
    assert "package.xml" in caught.value.zh


def test_a_package_is_shown_as_one_text() -> None:
    lines = text_of(KEPT).splitlines()
    number = line_in_text(KEPT, f"{NAME}/{NAME}/helper.py", 5)
    assert lines[number - 1].strip() == "msg = Twist()"
    assert lines[0] == f"# ===== {NAME}/{NAME}/__init__.py ====="
    assert "setup(" in text_of(KEPT)
    assert "setup(" not in code_of(KEPT)


def test_a_script_is_shown_as_it_is() -> None:
    assert text_of(b"x = 1\n") == code_of(b"x = 1\n") == "x = 1\n"
    assert line_in_text(b"x = 1\n", "a.py", 1) == 1


def test_long_paths_in_what_is_left_out_do_not_matter() -> None:
    far = {f"ws/build/{'deep/' * 30}{'x' * 200}.o": "x"}
    assert bundled(zipped({**below("ws/src", FILES), **far})) == KEPT


@pytest.mark.parametrize(
    "paths",
    [
        [f"{'x/' * 800}package.xml", f"{'x/' * 800}{'log/' * 800}y.py"],
        [f"{number}/package.xml" for number in range(8_000)],
    ],
    ids=["deep", "many"],
)
def test_sorting_out_what_is_kept_takes_no_time(paths: list[str]) -> None:
    """Any student may upload such a zip. Comparing everything with everything took the service seconds."""
    before_s = time.process_time()
    kept = own_files(paths)
    assert len(package_folders(kept)) == sum(path.endswith("package.xml") for path in paths)
    assert len(kept) == len(paths)
    assert time.process_time() - before_s < 1.0
