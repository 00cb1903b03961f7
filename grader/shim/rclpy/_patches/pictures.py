"""matplotlib for a host without a screen: everything can be called, nothing is drawn.

Students plot where the turtle went; that says nothing of how it drove, and must not end their scripts. What does
matter is kept: `show` blocks until the window is closed, which nobody does, `pause` sleeps, animations are called.
"""

from __future__ import annotations

import itertools
from _frozen_importlib import ModuleSpec
from types import ModuleType

from rclpy._kernel import kernel
from rclpy._link import link
from rclpy._storage.open_files import open as open_file

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence
    from typing import Any

VERSION = "3.5.1"
_WITHOUT_WINDOWS = frozenset({"agg", "cairo", "pdf", "pgf", "ps", "svg", "template"})


class Picture:
    """Any object of matplotlib."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return _answers.get(name) or Picture()

    def __call__(self, *args: Any, **options: Any) -> Any:
        return Picture()

    def __getitem__(self, key: Any) -> Any:
        return Picture()

    def __setitem__(self, key: Any, value: Any) -> None:
        return

    def __iter__(self) -> Any:
        return iter(())

    def __len__(self) -> int:
        return 0

    def __bool__(self) -> bool:
        return True

    def __enter__(self) -> Picture:
        return self

    def __exit__(self, *details: object) -> None:
        return


class Style(Picture):
    """`matplotlib.style`, whose `use` chooses colours."""

    def use(self, *args: Any, **options: Any) -> None:
        return


class Grid(list[object]):
    """What `subplots` returns for several: an array of axes."""

    def __getitem__(self, key: Any) -> Any:
        return Picture() if isinstance(key, tuple) else super().__getitem__(key)

    @property
    def flat(self) -> list[object]:
        """All axes in one row."""
        return [axes for row in self for axes in (row if isinstance(row, Grid) else [row])]

    def flatten(self) -> list[object]:
        return self.flat

    ravel = flatten


class _Window:
    """What the script's calls have made of the one window.

    Attributes:
        blocks: whether `show` waits for it to be closed.
        animations: function and interval of each animation.
    """

    def __init__(self) -> None:
        self.blocks = True
        self.animations: list[tuple[Callable[[], None], int]] = []


_window = _Window()


def _use(backend: str, **options: Any) -> None:
    _window.blocks = str(backend).lower() not in _WITHOUT_WINDOWS


def _ion() -> Picture:
    _window.blocks = False
    return Picture()


def _ioff() -> Picture:
    _window.blocks = True
    return Picture()


def _show(*args: Any, block: bool | None = None, **options: Any) -> None:
    if not (_window.blocks if block is None else block):
        return
    due = [(kernel.now_ns + interval_ns, step, interval_ns) for step, interval_ns in _window.animations]
    while due:
        at_ns, step, interval_ns = due.pop(min(range(len(due)), key=lambda place: due[place][0]))
        kernel.sleep_ns(max(at_ns - kernel.now_ns, 0))
        step()
        due.append((at_ns + interval_ns, step, interval_ns))
    kernel.wait(lambda: False, None, "show() waits for the window to be closed", idle=True)


def _pause(interval: float) -> None:
    kernel.sleep_ns(max(round(interval * 1e9), 0))


def _animate(
    fig: object,
    func: Callable[..., object],
    frames: Any = None,
    init_func: Callable[[], object] | None = None,
    fargs: Sequence[Any] | None = None,
    *args: Any,
    interval: float = 200,
    repeat: bool = True,
    **options: Any,
) -> Picture:
    """`FuncAnimation`: `func` is called every `interval` ms while the window is shown."""
    frames = frames() if callable(frames) else range(frames) if isinstance(frames, int) else frames
    turns: Iterable[Any]
    turns = itertools.count() if frames is None else itertools.cycle(frames) if repeat else frames
    turn = iter(turns)

    def step() -> None:
        for frame in itertools.islice(turn, 1):
            func(frame, *(fargs or ()))

    if init_func is not None:
        init_func()
    _window.animations.append((step, max(round(interval * 1e6), 1_000_000)))
    return Picture()


def _savefig(fname: Any, *args: Any, **options: Any) -> None:
    if not hasattr(fname, "write"):
        open_file(fname, "wb").close()


def _axes(nrows: int = 1, ncols: int = 1, *args: Any, **options: Any) -> Any:
    if nrows == ncols == 1:
        return Picture()
    if 1 in (nrows, ncols):
        return Grid(Picture() for _ in range(nrows * ncols))
    return Grid(Grid(Picture() for _ in range(ncols)) for _ in range(nrows))


_answers: dict[str, Any] = {
    "FuncAnimation": _animate,
    "axis": lambda *_, **__: (0.0, 1.0, 0.0, 1.0),
    "get_data": lambda *_: ([], []),
    "get_legend_handles_labels": lambda *_: ([], []),
    "get_size_inches": lambda *_: (6.4, 4.8),
    "get_xlim": lambda *_: (0.0, 1.0),
    "get_ylim": lambda *_: (0.0, 1.0),
    "hist": lambda *_, **__: ([], [], []),
    "ioff": _ioff,
    "ion": _ion,
    "pause": _pause,
    "plot": lambda *_, **__: [Picture()],
    "savefig": _savefig,
    "show": _show,
    "subplots": _axes,
    "switch_backend": _use,
    "use": _use,
    "xlim": lambda *_, **__: (0.0, 1.0),
    "ylim": lambda *_, **__: (0.0, 1.0),
}
"""Names, of modules and of objects alike, whose answers scripts unpack or wait for."""


_PYPLOT = (
    "annotate arrow axes axhline axis axvline bar cla clf close draw errorbar figure fill gca gcf grid hist "
    "ioff ion legend pause plot quiver rcParams savefig scatter show step subplot subplots text tight_layout "
    "title xlabel xlim xticks ylabel ylim yticks"
)
"""What ``from matplotlib.pyplot import *`` gives."""


class _Module(ModuleType):
    """Any module of matplotlib."""

    def __getattr__(self, name: str) -> Any:
        if name == "__version__":
            return VERSION
        if name == "__all__" and self.__name__ == "matplotlib.pyplot":
            return _PYPLOT.split()
        if name.startswith("__"):
            raise AttributeError(name)
        if name == "subplots":
            return lambda *args, **options: (Picture(), _axes(*args, **options))
        return Style() if name == "style" else getattr(self._kind(), name)

    def _kind(self) -> Picture:
        return Style() if self.__name__.endswith(".style") else Picture()


def spec_of(name: str) -> ModuleSpec:
    """Return the spec of any module of matplotlib."""
    loader: Any = _Loader
    return ModuleSpec(name, loader, is_package=True)


class _Loader:
    """Loads what `spec_of` finds."""

    @staticmethod
    def create_module(spec: ModuleSpec) -> ModuleType:
        return _Module(spec.name)

    @staticmethod
    def exec_module(module: ModuleType) -> None:
        if "." not in module.__name__:
            link.note("no_pictures", module.__name__)
