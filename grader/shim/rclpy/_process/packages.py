"""A student's package: its files in the storage, its modules importable, its executable called as ros2 run does.

START brings the files as one run of bytes and says what colcon would have installed where; nothing of the package
is read or executed to find that out.
"""

from __future__ import annotations

import sys
from _frozen_importlib import ModuleSpec

from rclpy._patches import tracebacks
from rclpy._process import loops
from rclpy._storage.entries import WORK
from rclpy._storage.tree import storage

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import CodeType, ModuleType
    from typing import Any

_AFTER = "FrozenImporter"
"""Of the finders the one before the student's modules: PYTHONPATH precedes Python's own library."""


class Workspace:
    """What of a workspace is installed; a finder and loader of its modules. Empty unless START brings a package.

    Attributes:
        names: of the packages that ros2 finds, with their install folders.
        launch: the launch file that is started; empty: none.
        modules: of the student's, in order of import.
    """

    def __init__(self) -> None:
        self.names: dict[str, str] = {}
        self.launch = ""
        self.modules: list[ModuleType] = []
        self._files: dict[str, bytes] = {}
        self._known: dict[str, tuple[str, bool, str]] = {}
        self._executables: list[tuple[str, str, str, str]] = []
        self._run: tuple[str, ...] = ()
        self._installed: dict[str, str] = {}

    def mount(self, fields: dict[str, Any], body: bytes) -> None:
        """Take over START's ``package`` and the files."""
        start = 0
        for path, size in fields["files"]:
            self._files[path] = body[start : start + size]
            start += size
        self.names = fields["packages"]
        self.launch = fields["launch"]
        self._executables = [tuple(executable) for executable in fields["executables"]]
        self.choose(*fields["run"])
        self._installed = {f"{WORK}/{installed}": path for installed, path in fields["shared"]}
        placed = {path: storage.place(f"{WORK}/src/{path}", data) for path, data in self._files.items()}
        for name, path, is_package, installed in fields["modules"]:
            self._known[name] = (path, is_package, f"{WORK}/{installed}")
            if path:
                storage.link(f"{WORK}/{installed}", placed[path])
        for installed, path in fields["shared"]:
            storage.link(f"{WORK}/{installed}", placed[path])
        own = {path: data for path, data in self._files.items() if path.endswith(".py")}
        tracebacks.script.files.update(own)
        at = next(i for i, each in enumerate(sys.meta_path) if getattr(each, "__name__", "") == _AFTER)
        sys.meta_path.insert(at + 1, self)

    def choose(self, *executable: str) -> None:
        """Set what `call` runs: a package and the name of its executable, or nothing."""
        self._run = executable

    def module_names(self) -> list[str]:
        """Return the names of all modules that are installed."""
        return list(self._known)

    def executables_of(self, package: str) -> list[str]:
        """Return the names of a package's executables, as they are installed."""
        return [executable[1] for executable in self._executables if executable[0] == package]

    def launch_path(self) -> str:
        """Return where the launch file is installed; nothing where it is not."""
        shared = (path for path in self._installed if "/share/" in path)
        found = sorted(path for path in shared if path.rpartition("/")[2] == self.launch)
        return found[0] if found else ""

    def shown(self, path: str) -> str:
        """Return how tracebacks call a file that is installed: as it is called in the archive."""
        return self._installed.get(path, path)

    def entry_source(self) -> tuple[str, bytes]:
        """Return path and content of the module that is called; of nothing where there is none."""
        path = next(
            (self._known[executable[2]][0] for executable in self._chosen() if executable[2] in self._known),
            "",
        )
        return path, self._files.get(path, b"")

    def prefixes(self) -> list[str]:
        """Return where the packages are installed."""
        return [f"{WORK}/install/{folder}" for folder in dict.fromkeys(self.names.values())]

    def prefix_of(self, name: str) -> str:
        """Return where a package is installed; nothing where ros2 does not find it."""
        return f"{WORK}/install/{self.names[name]}" if name in self.names else ""

    def argv0(self) -> str:
        """Return the path of the executable, as ``sys.argv[0]`` has it."""
        return next((executable_path(executable[0], executable[1]) for executable in self._chosen()), "ros2")

    def call(self) -> None:
        """Do what the executable's own few lines do: import the module and exit with what its function returns.

        Raises:
            SystemExit, and whatever the module raises.
        """
        for _, _, name, function in self._chosen():
            __import__(name)
            called: Any = sys.modules[name]
            for attribute in function.split("."):
                called = getattr(called, attribute)
            sys.exit(called())
        if self._run and self._run[0] not in self.names:
            sys.stderr.write(f"Package '{self._run[0]}' not found\n")
        else:
            sys.stderr.write("No executable found\n")
        sys.exit(1)

    def _chosen(self) -> list[tuple[str, str, str, str]]:
        return [executable for executable in self._executables if executable[:2] == self._run][:1]

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return the spec of an installed module, None for anything else."""
        if fullname not in self._known:
            return None
        source, is_package, installed = self._known[fullname]
        loader: Any = self if source else None  # a folder without __init__.py is a namespace
        spec = ModuleSpec(fullname, loader, origin=installed if source else None, is_package=is_package)
        spec.has_location = bool(source)
        if is_package:
            spec.submodule_search_locations = [installed.rpartition("/")[0]]
        return spec

    @staticmethod
    def create_module(spec: ModuleSpec) -> None:
        """Ask for an ordinary module."""

    def exec_module(self, module: ModuleType) -> None:
        """Run a module of the student's."""
        path = self._known[module.__name__][0]
        self.modules.append(module)
        code: CodeType = loops.compile_script(self._files[path], path)
        exec(code, module.__dict__)  # noqa: S102

    @staticmethod
    def get_data(path: str) -> bytes:
        """Return what a file contains, for `pkgutil`. Raises OSError: there is no such file."""
        with open(path, "rb") as file:
            return file.read()

    def get_resource_reader(self, name: str) -> Any:
        """Return what `importlib.resources` finds the files beside a package's modules with."""
        from importlib.readers import FileReader
        from types import SimpleNamespace

        loader: Any = SimpleNamespace(path=self._known[name][2])
        return FileReader(loader)

    def get_source(self, name: str) -> str:
        """Return a module's text, for `inspect`."""
        return self._files[self._known[name][0]].decode("utf-8", "replace")


def executable_path(package: str, name: str) -> str:
    """Return where colcon installs an executable."""
    return f"{WORK}/install/{package}/lib/{package}/{name}"


workspace = Workspace()
