"""A package in a folder of this computer, in the form in which a service would keep it."""

import os
from pathlib import Path

from grader.contracts.errors import RefusedError
from grader.contracts.text import Text
from grader.formats.packages.archives import BOUNDS
from grader.formats.packages.bundle import bundle_of, own_files

_MOST_NAMES = 20_000


def read_folder(folder: Path) -> bytes:
    """Return the packages in and below a folder as they are kept. Links are not followed.

    Raises:
        RefusedError: ``no_package``, or more than a zip may hold.
        OSError: a file cannot be read.
    """
    top = folder.resolve()
    files: dict[str, Path] = {}
    for root, folders, names in os.walk(top):
        folders[:] = [each for each in sorted(folders) if not each.startswith(".")]
        for name in names:
            path = Path(root, name)
            if path.is_file() and not path.is_symlink():
                files[f"{top.name}/{path.relative_to(top).as_posix()}"] = path
        if len(files) > _MOST_NAMES:
            raise _too_many(folder)
    kept = own_files(files)
    if len(kept) > BOUNDS.files:
        raise _too_many(folder)
    return bundle_of({path: read_bounded(files[path], BOUNDS.file_bytes) for path in kept})


def read_bounded(path: Path, most: int) -> bytes:
    """Return the content of a file of at most `most` bytes.

    Raises:
        RefusedError: ``too_large``.
        OSError: it cannot be read.
    """
    with path.open("rb") as file:
        content = file.read(most + 1)
    if len(content) > most:
        kib = most // 1024
        text = Text(zh=f"{path}：超过 {kib} KiB", en=f"{path}: more than {kib} KiB")
        raise RefusedError("too_large", text, field="file")
    return content


def _too_many(folder: Path) -> RefusedError:
    return RefusedError.saying(
        "bad_archive",
        zh=f"{folder} 里的文件太多：请指明功能包自己的文件夹（里面有 package.xml）",
        en=f"{folder} holds too many files: name the package's own folder, the one with package.xml",
        field="file",
    )
