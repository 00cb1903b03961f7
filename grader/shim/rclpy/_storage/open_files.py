"""`open`, for the files of `storage` as well as for real ones."""

from __future__ import annotations

import errno
import io
import os
from _operator import index
from io import BufferedRandom, BufferedReader, BufferedWriter, RawIOBase, TextIOWrapper

from rclpy._storage.descriptors import Description, close, described, descriptors, open_path
from rclpy._storage.entries import BLOCK_BYTES
from rclpy._storage.tree import storage

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

_real_open = io.open


class FileIO(RawIOBase):
    """A descriptor's bytes without a buffer; stands for `io.FileIO`."""

    _blksize = BLOCK_BYTES

    def __init__(self, number: int, name: Any, mode: str, closefd: bool) -> None:
        super().__init__()
        self.name = name
        self.mode = mode
        self.closefd = closefd
        self._number = number
        self._description = described(number)
        if "a" in mode:
            self._description.seek(0, os.SEEK_END)

    def __repr__(self) -> str:
        if self.closed:
            return "<_io.FileIO [closed]>"
        return f"<_io.FileIO name={self.name!r} mode={self.mode!r} closefd={self.closefd}>"

    def _open(self) -> Description:
        if self.closed:
            raise ValueError("I/O operation on closed file")
        return self._description

    def fileno(self) -> int:
        self._open()
        return self._number

    def isatty(self) -> bool:
        self._open()
        return False

    def seekable(self) -> bool:
        self._open()
        return True

    def readable(self) -> bool:
        return "r" in self.mode or "+" in self.mode if self._open() else False

    def writable(self) -> bool:
        return self.mode != "rb" if self._open() else False

    def readinto(self, buffer: Any, /) -> int:
        view = memoryview(buffer).cast("B")
        data = self._reading().read(len(view))
        view[: len(data)] = data
        return len(data)

    def readall(self) -> bytes:
        return self._reading().read(len(self._description.file.data))

    def _reading(self) -> Description:
        if not self.readable():
            raise io.UnsupportedOperation("File not open for reading")
        return self._description

    def write(self, data: Any, /) -> int:
        if not self.writable():
            raise io.UnsupportedOperation("File not open for writing")
        return self._description.write(data)

    def seek(self, offset: int, whence: int = 0, /) -> int:
        return self._open().seek(offset, whence)

    def tell(self) -> int:
        return self._open().position

    def truncate(self, size: int | None = None, /) -> int:
        if not self.writable():
            raise io.UnsupportedOperation("File not open for writing")
        size = self._description.position if size is None else size
        if size < 0:
            raise OSError(errno.EINVAL, os.strerror(errno.EINVAL))
        storage.resize(self._description.file, size)
        return size

    def close(self) -> None:
        if not self.closed:
            super().close()
            if self.closefd:
                close(self._number)


FileIO.__module__ = "_io"

_FLAGS = {"r": 0, "w": os.O_CREAT | os.O_TRUNC, "x": os.O_CREAT | os.O_EXCL, "a": os.O_CREAT | os.O_APPEND}


def open(
    file: Any,
    mode: str = "r",
    buffering: int = -1,
    encoding: str | None = None,
    errors: str | None = None,
    newline: str | None = None,
    closefd: bool = True,
    opener: Callable[[Any, int], int] | None = None,
) -> Any:
    """Python's `open`, which opens files of the storage as well as real ones.

    Raises:
        OSError, ValueError, TypeError: as Python's.
    """
    if isinstance(mode, str):
        _check(mode, encoding, errors, newline)
    buffering = index(buffering)  # an encoding given in its place raises Python's own error
    number = file if isinstance(file, int) else None
    file = os.fspath(file) if isinstance(file, os.PathLike) else file
    parts = storage.parts(file)
    if opener is not None and number is None and isinstance(mode, str):
        number = opener(file, _flags(mode) | os.O_CLOEXEC)
        real_number = number
        opener = lambda *_: real_number  # noqa: E731
    if (parts is None if number is None else number not in descriptors) or not isinstance(mode, str):
        path = storage.elsewhere(file)
        return _real_open(path, mode, buffering, encoding, errors, newline, closefd, opener)
    if number is None:
        if not closefd:
            raise ValueError("Cannot use closefd=False with file name")
        assert parts is not None
        number = open_path(file, parts, _flags(mode))
    raw = FileIO(number, file, _raw_mode(mode), closefd)
    try:
        return _wrap(raw, mode, buffering, encoding, errors, newline)
    except BaseException:
        raw.close()
        raise


def _flags(mode: str) -> int:
    flags = sum(_FLAGS.get(letter, 0) for letter in mode)
    if "+" in mode:
        return flags | os.O_RDWR
    return flags | (os.O_RDONLY if "r" in mode else os.O_WRONLY)


def _raw_mode(mode: str) -> str:
    """Return the mode as `io.FileIO` words it."""
    letter = next(letter for letter in "xarw" if letter in mode)
    if "+" not in mode:
        return f"{letter}b"
    return f"{'r' if letter == 'w' else letter}b+"


def _check(mode: str, encoding: str | None, errors: str | None, newline: str | None) -> None:
    """Refuse what Python refuses, in its words."""
    if set(mode) - set("axrwb+t") or len(mode) > len(set(mode)):
        raise ValueError(f"invalid mode: {mode!r}")
    if "t" in mode and "b" in mode:
        raise ValueError("can't have text and binary mode at once")
    letters = sum(letter in mode for letter in "axrw")
    if letters > 1:
        raise ValueError("must have exactly one of create/read/write/append mode")
    if "b" in mode:
        for name, value in (("encoding", encoding), ("errors", errors), ("newline", newline)):
            if value is not None:
                raise ValueError(f"binary mode doesn't take {_ARTICLES[name]} {name} argument")
    if not letters:
        raise ValueError("Must have exactly one of create/read/write/append mode and at most one plus")


_NO_LINES = (
    "line buffering (buffering=1) isn't supported in binary mode, the default buffer size will be used"
)
_ARTICLES = {"encoding": "an", "errors": "an", "newline": "a"}


def _wrap(
    raw: FileIO, mode: str, buffering: int, encoding: str | None, errors: str | None, newline: str | None
) -> Any:
    """Return `raw` with the buffer and the text layer that `mode` asks for."""
    if buffering == 0:
        if "b" not in mode:
            raise ValueError("can't have unbuffered text I/O")
        return raw
    size = buffering if buffering > 1 else BLOCK_BYTES
    buffer: Any
    if "+" in mode:
        buffer = BufferedRandom(raw, size)
    elif "r" in mode:
        buffer = BufferedReader(raw, size)
    else:
        buffer = BufferedWriter(raw, size)
    if buffering == 1 and "b" in mode:
        import warnings

        warnings.warn(_NO_LINES, RuntimeWarning, stacklevel=3)
    if "b" in mode:
        return buffer
    text: Any = TextIOWrapper(buffer, encoding, errors, newline, line_buffering=buffering == 1)
    text.mode = mode
    return text
