"""The option ``--plot`` of the commands that run a script."""

from pathlib import Path
from typing import TYPE_CHECKING

from grader.contracts.errors import RefusedError
from grader.contracts.text import Text, trouble

if TYPE_CHECKING:
    from grader.contracts.figure import PictureForm


def check_plot_path(path: Path) -> None:
    """Refuse, before anything is run, a file that could not be written or has no known form.

    Raises:
        RefusedError: its name does not end in .png or .svg, or its folder does not exist.
    """
    if path.suffix.lower() not in (".png", ".svg"):
        raise RefusedError(
            "plot_format",
            Text(
                zh=f"--plot {path}：文件名要以 .png 或 .svg 结尾",
                en=f"--plot {path}: the name must end in .png or .svg",
            ),
        )
    if not path.resolve().parent.is_dir():
        raise RefusedError(
            "plot_folder",
            Text(
                zh=f"--plot {path}：没有文件夹 {path.resolve().parent}",
                en=f"--plot {path}: the folder {path.resolve().parent} does not exist",
            ),
        )


def form_of(path: Path) -> "PictureForm":
    """Return the form that a file's name tells, and keep matplotlib from telling of itself."""
    import logging

    # On a new machine matplotlib logs its search for fonts, none of which is used.
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
    return "png" if path.suffix.lower() == ".png" else "svg"


def write_plot(path: Path, picture: bytes) -> None:
    """Write a picture to the file of ``--plot``.

    Raises:
        RefusedError: the operating system refused it.
    """
    try:
        path.write_bytes(picture)
    except OSError as error:
        raise file_error("plot_file", f"--plot {path}", error) from error


def file_error(code: str, name: str, error: OSError) -> RefusedError:
    """Return the operating system's error about a file, in both languages."""
    told = trouble(error)
    return RefusedError(code, Text(zh=f"{name}：{told.zh}", en=f"{name}: {told.en}"))
