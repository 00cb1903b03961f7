"""What the script's objects have as ``__del__`` at the end of Python, when nothing can be imported any more."""

from __future__ import annotations

import gc
import sys
import traceback  # noqa: F401 - what prints errors of ``__del__`` needs it

from rclpy._interfaces.messages import STRUCTURES
from rclpy.impl.rcutils_logger import RcutilsLogger

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, NoReturn


def _import_at_the_end(*_: Any, **__: Any) -> NoReturn:
    """Do as upstream's functions that import something while they run."""
    raise ImportError("sys.meta_path is None, Python is likely shutting down")


def end_imports() -> None:
    """Let nothing be imported any more, also not by upstream's generated constructors and by its loggers.

    A constructor imports the classes of nested messages, and `Sequence` for arrays. So a script that wants to stop
    the turtle in its ``__del__`` fails at ``Twist()``, as at home.
    """
    setattr(sys, "meta_path", None)  # noqa: B010 - declared as a list
    for cls, structure in STRUCTURES.items():
        if any(field.is_nested or field.is_message for field in structure.fields):
            setattr(cls, "__init__", _import_at_the_end)  # noqa: B010
    setattr(RcutilsLogger, "log", _import_at_the_end)  # noqa: B010


def finalize(names: dict[str, Any]) -> None:
    """Finalize what a module holds.

    Python's last collection finds the module with all it holds unreachable and finalizes the instances while
    the globals are still there (PEP 442); here the module stays, so its instances go first.
    """
    for name in [name for name, value in names.items() if hasattr(type(value), "__del__")]:
        del names[name]
    gc.collect()
