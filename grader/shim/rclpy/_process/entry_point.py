"""A script that is started as ros2 run starts an executable: its module is imported, then its `main` is called.

That is what the few lines do that setuptools writes for an entry point ``name = package.module:main``.
"""

from __future__ import annotations

import _ast
import builtins
import sys
from _frozen_importlib import ModuleSpec
from types import CodeType, ModuleType

from rclpy._link import link

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class EntryPoint:
    """A script as a module that is named like its file, and the call of its `main`.

    Attributes:
        module: empty until `call`.
    """

    def __init__(self, file_name: str, source: bytes) -> None:
        name = file_name.rpartition("/")[2].removesuffix(".py")
        self._source = source
        self.module = ModuleType(name)
        names: dict[str, Any] = {
            "__file__": file_name,
            "__spec__": ModuleSpec(name, None, origin=file_name),
            "__builtins__": builtins,
        }
        self.module.__dict__.update(names)

    def call(self, code: CodeType) -> None:
        """Import the script, call its `main` and exit with what that returns.

        Raises:
            SystemExit, and whatever the script raises; AttributeError where it has no `main`.
        """
        if note := _note(self._source):
            link.note(note)
        if not _is_taken(self.module.__name__):
            sys.modules[self.module.__name__] = self.module
        exec(code, self.module.__dict__)  # noqa: S102
        main: Any = getattr(self.module, "main")  # noqa: B009 - the error of a module that has none
        sys.exit(main())


def _is_taken(name: str) -> bool:
    """Whether something else is imported by the name of the script: in its package it has a longer one."""
    import importlib.util

    try:
        return name in sys.modules or importlib.util.find_spec(name) is not None
    except (ImportError, ValueError):
        return True


def _note(source: bytes) -> str:
    """Return the note on a script that calls its `main` otherwise than an entry point wants it; empty: none."""
    tree: Any = compile(source, "", "exec", _ast.PyCF_ONLY_AST, dont_inherit=True)
    if not any(
        isinstance(statement, _ast.FunctionDef) and statement.name == "main" for statement in tree.body
    ):
        return ""
    if any(_calls_main(statement) for statement in tree.body):
        return "main_twice"
    guarded = any(
        isinstance(statement, _ast.If) and any(map(_calls_main, statement.body)) for statement in tree.body
    )
    return "" if guarded else "main_called"


def _calls_main(statement: _ast.stmt) -> bool:
    """Whether a statement is ``main()``, or hands on what that returns, as ``sys.exit(main())`` does."""
    call = statement.value if isinstance(statement, _ast.Expr) else None
    while isinstance(call, _ast.Call):
        if getattr(call.func, "id", "") == "main":
            return True
        call = call.args[0] if call.args else None
    return False
