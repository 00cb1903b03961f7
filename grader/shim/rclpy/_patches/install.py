"""Puts virtual time and a repeatable host behind the standard library, before the script is compiled.

`time`, `_thread` and `os` change at once, every other module when it is first imported (or now, when it is
imported already). Names that already imported modules have copied (`from time import monotonic`) follow.
"""

from __future__ import annotations

import _thread
import builtins
import io
import os
import sys
import time
from importlib import import_module
from importlib.machinery import ModuleSpec

from rclpy._patches import files, host, programs, threads
from rclpy._patches import time as time_patch

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from types import ModuleType
    from typing import Any

LAZY = {
    "_curses": ("host", "patch_curses"),
    "_multiprocessing": ("locks", "patch_multiprocessing"),
    "_tkinter": ("host", "patch_tkinter"),
    "asyncio": ("python_3_10", "restore"),
    "asyncio.base_events": ("threads", "patch_event_loop"),
    "concurrent.futures.thread": ("threads", "patch_futures_thread"),
    "linecache": ("tracebacks", "prime_linecache"),
    "dataclasses": ("python_3_10", "restore"),
    "dbm": ("host", "patch_dbm"),
    "datetime": ("datetime", "patch_datetime"),
    "enum": ("python_3_10", "restore"),
    "logging": ("threads", "patch_logging"),
    "multiprocessing.connection": ("select", "patch_connection"),
    "numpy": ("numpy", "patch_names"),
    "numpy.lib._datasource": ("numpy", "patch_datasource"),
    "numpy.lib._format_impl": ("numpy", "patch_format"),
    "numpy.lib.format": ("numpy", "patch_format"),
    "queue": ("threads", "patch_queue"),
    "random": ("host", "patch_random"),
    "resource": ("host", "patch_resource"),
    "sched": ("time", "patch_sched"),
    "select": ("select", "patch_select"),
    "selectors": ("select", "patch_selectors"),
    "signal": ("signal", "patch_signal"),
    "socket": ("host", "patch_socket"),
    "subprocess": ("programs", "patch_subprocess"),
    "threading": ("threads", "patch_threading"),
    "traceback": ("tracebacks", "patch_traceback"),
    "uuid": ("host", "patch_uuid"),
}
"""Module -> (our module, of this package unless it has a dot, function called with it once it is there)."""

_OURS = ("rclpy._kernel", "rclpy._link", "rclpy._patches", "rclpy._process", "rclpy._storage")
_SYSTEM = ("posix", "_io")
"""Modules of the import system, which keep the real files: they read the shim and the standard library."""


def install() -> None:
    """Replace what is there already; to be called once, in the student's process, before `begin`."""
    _replace()
    host.set_environment()
    sys.meta_path.insert(0, PostImport())


def begin(seed: int) -> None:
    """Make the host repeatable from `seed` on, and patch the modules that are imported already."""
    host.seed_entropy(seed)
    for name in LAZY:
        module = sys.modules.get(name)
        if module is not None:
            apply(name, module)


def apply(name: str, module: ModuleType) -> None:
    """Run the patch of the module called `name`."""
    ours, function = LAZY[name]
    home = ours if "." in ours else f"rclpy._patches.{ours}"
    getattr(import_module(home), function)(module)


def find_copies() -> None:
    """Look, ahead of `install`, for the names that the modules imported so far have copied."""
    replacements = _replacements()
    for name, module in tuple(sys.modules.items()):
        if name not in _searched and not name.startswith(_OURS):
            _searched[name] = module
            _copies.extend(_copies_in(module, replacements))


class Builtin(staticmethod):  # type: ignore[type-arg]
    """A function that is no method as a class's attribute, and is copied and called as those written in C.

    `logging.Formatter.converter` is `time.localtime`; a method it must not become. Who forgets the parentheses of
    ``time.time()`` meets the type's name in the error.
    """

    def __init__(self, function: Callable[..., Any], module: str) -> None:
        super().__init__(function)
        self.__module__ = module

    def __repr__(self) -> str:
        return f"<built-in function {self.__name__}>"

    def __reduce__(self) -> str:
        return self.__name__


Builtin.__name__ = Builtin.__qualname__ = "builtin_function_or_method"
Builtin.__module__ = "builtins"


def _like_builtins(module: ModuleType, table: dict[str, object]) -> dict[str, object]:
    """Return `table` with functions that behave as those written in C."""
    function: Any = type(_like_builtins)
    name = module.__name__
    return {key: Builtin(new, name) if isinstance(new, function) else new for key, new in table.items()}


_FILES = _like_builtins(os, files.REPLACED)
_OPEN = _like_builtins(io, files.REPLACED_OPEN)
_REPLACED: tuple[tuple[ModuleType, dict[str, object]], ...] = (
    (time, _like_builtins(time, time_patch.REPLACED)),
    (_thread, _like_builtins(_thread, threads.REPLACED)),
    (os, _like_builtins(os, {**host.REPLACED, **programs.REPLACED})),
    (sys, _like_builtins(sys, host.REPLACED_SYS)),
    (os, _FILES),
    (io, _OPEN),
    (builtins, _OPEN),
)
_system_keeps = (*_FILES.values(), *_OPEN.values())
_searched: dict[str, ModuleType] = {}
_copies: list[tuple[dict[str, object], str, object]] = []
"""Copies that were found: the namespace of a module, the name in it, and the replacement."""


def _replacements() -> dict[int, tuple[object, object]]:
    """Return original and replacement by the original's id."""
    replaced: dict[int, tuple[object, object]] = {}
    for module, table in _REPLACED:
        for name, replacement in table.items():
            original = getattr(module, name, None)
            if original is not None:
                replaced[id(original)] = (original, replacement)
    return replaced


def _replace() -> None:
    if not _searched:  # else what is imported now was looked through before the fork (`warm`)
        find_copies()  # before the originals are gone
    for module, table in _REPLACED:
        for name, replacement in table.items():
            if hasattr(module, name):
                setattr(module, name, replacement)
    for names, name, replacement in _copies:
        names[name] = replacement


def _copies_in(
    module: Any, replacements: dict[int, tuple[object, object]]
) -> list[tuple[dict[str, object], str, object]]:
    names = getattr(module, "__dict__", None)
    if not isinstance(names, dict):
        return []
    return [
        (names, name, replacements[id(value)][1])
        for name, value in names.items()
        if id(value) in replacements
        and not (names.get("__name__") in _SYSTEM and replacements[id(value)][1] in _system_keeps)
    ]


class PostImport:
    """Meta path finder that lets a patch run right after the module it is for."""

    def __init__(self) -> None:
        self._busy: set[str] = set()

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if name not in LAZY or name in self._busy:
            return None
        self._busy.add(name)
        try:
            spec = self._find(name, path)
        finally:
            self._busy.discard(name)
        if spec is not None and spec.loader is not None:
            loader: Any = PatchingLoader(spec.loader)
            spec.loader = loader
        return spec

    def _find(self, name: str, path: Sequence[str] | None) -> ModuleSpec | None:
        for finder in sys.meta_path:
            find: Callable[..., ModuleSpec | None] | None = getattr(finder, "find_spec", None)
            spec = find(name, path) if find is not None else None
            if spec is not None:
                return spec
        return None


class PatchingLoader:
    """Loads as the real loader does, then runs the patch."""

    def __init__(self, real: Any) -> None:
        self._real = real

    def __getattr__(self, name: str) -> Any:
        return getattr(self._real, name)

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        module: ModuleType | None = self._real.create_module(spec)
        return module

    def exec_module(self, module: ModuleType) -> None:
        spec: Any = module.__spec__
        spec.loader = self._real
        module.__loader__ = self._real
        self._real.exec_module(module)
        apply(spec.name, module)
