"""What is in the image and what is not."""

import re
from pathlib import Path

from tests.container.running import python
from tools.image.runtime import Runtime

LARGEST_MB = 365  # 17 for models of PyBullet scripts, 20 for what numpy 1.26 is larger than 2, 8 for openpyxl
TOOLS = re.compile(
    r"pip[\d.]*|uv|easy_install.*|apt.*|dpkg.*|gcc.*|cc|c\+\+|g\+\+.*|clang.*|ld|as|make|strip|f2py|perl.*|"
    r"sh|bash|dash|busybox|su|sudo|mount|curl|wget|git"
)


def programs(rootfs: Path) -> list[str]:
    folders = ("usr/bin", "usr/sbin", "usr/local/bin", "opt/grader/bin")
    return [path.name for folder in folders for path in (rootfs / folder).glob("*")]


def test_it_is_small(runtime: Runtime) -> None:
    size_mb = runtime.image.size_bytes / 1e6
    print(f"\nimage: {size_mb:.0f} MB")
    assert size_mb < LARGEST_MB


def test_no_shell_installer_or_build_tool_is_inside(runtime: Runtime) -> None:
    found = programs(runtime.folder / "rootfs")
    assert set(found) >= {"grader", "python", "python3.11", "tini"}
    assert [name for name in found if TOOLS.fullmatch(name)] == []


def test_no_installer_or_test_suite_can_be_imported(runtime: Runtime) -> None:
    unwanted = ("ensurepip", "hatchling", "pip", "pybullet_envs", "pytest", "setuptools", "wheel")
    source = f"import importlib.util as u; print([name for name in {unwanted} if u.find_spec(name)])"
    assert python(runtime, "-c", source) == "[]\n"


def test_no_file_gives_its_users_rights_of_another(runtime: Runtime) -> None:
    files = [path for path in (runtime.folder / "rootfs").rglob("*") if not path.is_symlink()]
    assert len(files) > 5_000
    assert [str(path) for path in files if path.is_file() and path.stat().st_mode & 0o6000] == []


def test_everything_python_brings_can_be_imported(runtime: Runtime) -> None:
    """A shared library that was left out would show only then."""
    assert (
        python(runtime, "/scripts/import_everything.py") == "_dbm\nnis\n"
    )  # Berkeley DB and NIS: on purpose


def test_modules_are_compiled_ahead(runtime: Runtime) -> None:
    rootfs = runtime.folder / "rootfs"
    for folder in (rootfs / "opt/grader/lib/python3.11/site-packages", rootfs / "usr/lib/python3.11"):
        sources = [path for path in folder.rglob("*.py") if not {"assignments", "lesson"} & {*path.parts}]
        assert len(sources) > 500
        compiled = (path.parent / "__pycache__" / f"{path.stem}.cpython-311.pyc" for path in sources)
        assert [str(path) for path in compiled if not path.exists()] == []
    templates = rootfs / "opt/grader/lib/python3.11/site-packages/grader/service/web/templates"
    pages = {path.stem for path in templates.glob("*.html")}
    assert {path.name.partition(".")[0] for path in (templates / "__pycache__").iterdir()} == pages
