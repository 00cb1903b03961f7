"""The options ``--plot`` and ``--record`` of the commands that run a script."""

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from grader.contracts.errors import RefusedError
from grader.contracts.text import trouble

if TYPE_CHECKING:
    from grader.contracts.figure import PictureForm


def check_plot_path(path: Path) -> None:
    """Refuse, before anything is run, a file that could not be written or has no known form.

    Raises RefusedError: its name does not end in .png or .svg, or its folder does not exist.
    """
    if path.suffix.lower() not in (".png", ".svg"):
        raise RefusedError.saying(
            "plot_format",
            zh=f"--plot {path}：文件名要以 .png 或 .svg 结尾",
            en=f"--plot {path}: the name must end in .png or .svg",
        )
    require_folder("--plot", path)


def check_bag_path(path: Path) -> None:
    """Refuse, before anything is run, a bag that could not be written.

    Raises:
        RefusedError: its name does not end in .mcap, its folder or the package that writes bags does not exist.
    """
    if path.suffix.lower() != ".mcap":
        raise RefusedError.saying(
            "record_format",
            zh=f"--record {path}：文件名要以 .mcap 结尾",
            en=f"--record {path}: the name must end in .mcap",
        )
    require_folder("--record", path)
    if find_spec("mcap") is None:
        raise RefusedError.saying(
            "bags_not_installed",
            zh="--record 需要没有安装的软件包 mcap：安装 grader 时请带上附加项 bags，或运行 pip install mcap",
            en="--record needs the package mcap, which is not installed: install the grader with its extra "
            "bags, or run pip install mcap",
        )


def require_folder(option: str, path: Path) -> None:
    """Look whether the folder of a file that an option names is there, before anything is graded for it.

    Raises RefusedError: it is not.
    """
    folder = path.resolve().parent
    if not folder.is_dir():
        raise RefusedError.saying(
            "no_folder",
            zh=f"{option} {path}：没有文件夹 {folder}",
            en=f"{option} {path}: the folder {folder} does not exist",
        )


def of_case(path: Path, case: str, cases: Sequence[str]) -> Path:
    """Return the file of one case: the one that was named, or with the case's name where there are several."""
    return path if len(cases) == 1 else path.with_stem(f"{path.stem}-{case}")


def form_of(path: Path) -> "PictureForm":
    """Return the form that a file's name tells, and keep matplotlib from telling of itself."""
    import logging

    # On a new machine matplotlib logs its search for fonts, none of which is used.
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
    return "png" if path.suffix.lower() == ".png" else "svg"


def write_file(option: str, path: Path, content: bytes) -> None:
    """Write the file that an option names. Raises RefusedError: the operating system refused it."""
    try:
        path.write_bytes(content)
    except OSError as error:
        raise file_error("output_file", f"{option} {path}", error) from error


def file_error(code: str, name: str, error: OSError) -> RefusedError:
    """Return the operating system's error about a file, in both languages."""
    return RefusedError(code, trouble(error).about(name))
