"""Lets numpy read and write the files of `rclpy._storage`."""

from __future__ import annotations

from rclpy._storage.descriptors import descriptors
from rclpy._storage.open_files import open as open_file

TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import ModuleType
    from typing import Any


def patch_format(module: ModuleType) -> None:
    """Let `save` and `load` go through Python's files: numpy would take their descriptors for real ones."""
    target: Any = module
    real = target.isfileobj

    def isfileobj(f: Any) -> bool:
        return bool(real(f)) and f.fileno() not in descriptors

    target.isfileobj = isfileobj


def patch_datasource(module: ModuleType) -> None:
    """Replace the `open` that numpy took if it was imported before the script."""
    target: Any = module
    target._file_openers._file_openers[None] = open_file
