"""Import this, after `rclpy._process.warm`, in the process that scripts with PyBullet are forked from.

The extension, which takes a tenth of a second, is loaded once. Scripts see nothing of it before their
``import pybullet``.
"""

from __future__ import annotations

import importlib.util
import os
import sys
from contextlib import contextmanager
from importlib.machinery import EXTENSION_SUFFIXES, ExtensionFileLoader, ModuleSpec

from rclpy._patches import install
from rclpy._pybullet import calls, recorder, replay  # noqa: F401 - every run needs them
from rclpy._pybullet.module import module_from

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from types import ModuleType


def _load() -> ModuleType:
    """Load the extension, which lies beside `pybullet_data`: both come in one wheel."""
    data = importlib.util.find_spec("pybullet_data")
    if data is None or data.origin is None:
        raise ImportError("pybullet_data is not installed; install pybullet anew")
    folder = os.path.dirname(os.path.dirname(data.origin))
    names = (os.path.join(folder, "pybullet" + suffix) for suffix in EXTENSION_SUFFIXES)
    path = next(filter(os.path.exists, names), None)
    if path is None:
        raise ImportError("PyBullet's extension is not installed; install pybullet anew")
    spec = ModuleSpec("pybullet", ExtensionFileLoader("pybullet", path), origin=path)
    with _silenced():
        return importlib.util.module_from_spec(spec)  # which runs all there is to it


@contextmanager
def _silenced() -> Iterator[None]:
    """Discard what the extension prints while it is loaded, which is the time of its build."""
    null = os.open(os.devnull, os.O_WRONLY)
    kept = {stream: os.dup(stream) for stream in (1, 2)}
    for stream in kept:
        os.dup2(null, stream)
    try:
        yield
    finally:
        for stream, copy in kept.items():
            os.dup2(copy, stream)
            os.close(copy)
        os.close(null)


class PybulletFinder:
    """Finds `pybullet` for a script, which then begins to be recorded."""

    def __init__(self, real: ModuleType) -> None:
        self._module = module_from(real)
        self._path = real.__file__

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        return ModuleSpec(name, self, origin=self._path) if name == "pybullet" else None  # type: ignore[arg-type]

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        return self._module

    def exec_module(self, module: ModuleType) -> None:
        recorder.recorder.begin()


real = _load()
replay.bullet = real
sys.modules.pop("pybullet", None)
sys.meta_path.insert(0, PybulletFinder(real))
install.find_copies()
