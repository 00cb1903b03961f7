"""Lets numpy read and write the files of `rclpy._storage`, and have the names of the version at home.

Ubuntu 22.04 has numpy 1.21 (Humble), 24.04 has 1.26 (Jazzy).
"""

from __future__ import annotations

from rclpy import _distro
from rclpy._storage.descriptors import descriptors
from rclpy._storage.open_files import open as open_file

TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import ModuleType
    from typing import Any


# Deprecated there, which is said to nobody here.
_UP_TO_1_23 = {type_.__name__: type_ for type_ in (bool, int, float, complex, object, str)}
_UP_TO_1 = {
    "Inf": "inf",
    "NaN": "nan",
    "float_": "float64",
    "complex_": "complex128",
    "round_": "round",
    "product": "prod",
    "cumproduct": "cumprod",
    "alltrue": "all",
    "sometrue": "any",
    "trapz": "trapezoid",
    "in1d": "isin",
}


def patch_names(module: ModuleType) -> None:
    """Give numpy the names that a newer version than the one at home has dropped."""
    for name, other in _UP_TO_1.items():
        if not hasattr(module, name):
            setattr(module, name, getattr(module, other))
    if _distro.chosen == _distro.HUMBLE:
        for name, builtin in _UP_TO_1_23.items():
            module.__dict__.setdefault(name, builtin)


def patch_format(module: ModuleType) -> None:
    """Make `save` and `load` use Python's file objects: the descriptors of our files are not the kernel's."""
    target: Any = module
    real = target.isfileobj

    def isfileobj(f: Any) -> bool:
        return bool(real(f)) and f.fileno() not in descriptors

    target.isfileobj = isfileobj


def patch_datasource(module: ModuleType) -> None:
    """Replace the `open` that numpy took if it was imported before the script."""
    target: Any = module
    target._file_openers._file_openers[None] = open_file
