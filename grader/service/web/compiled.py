"""Templates, compiled once for all processes: compiling all of them takes half a second.

Python keeps what they become as it keeps compiled modules: in `__pycache__` beside them, if it may write there.
"""

from collections.abc import MutableMapping
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType
from typing import Any, cast

import jinja2
from jinja2 import Environment, FileSystemLoader, Template


class CompiledTemplates(FileSystemLoader):
    """Loads templates of a folder.

    Args:
        folder: of the templates.
        made_with: sources that say how templates are compiled: what was compiled before they changed is not used.
    """

    def __init__(self, folder: Path, *made_with: Path) -> None:
        super().__init__(folder)
        self._made_with = (Path(jinja2.__file__), *made_with)

    def load(
        self, environment: Environment, name: str, globals: MutableMapping[str, Any] | None = None
    ) -> Template:
        """Return a template."""
        _, path, is_same = self.get_source(environment, name)
        code = cast(CodeType, _Code(environment, name, path, self._made_with).get_code(name))
        known = {} if globals is None else globals
        return environment.template_class.from_code(environment, code, known, is_same)


class _Code(SourceFileLoader):
    """What one template becomes."""

    def __init__(self, environment: Environment, name: str, path: str, made_with: tuple[Path, ...]) -> None:
        super().__init__(name, path)
        self._environment = environment
        self._made_with = made_with

    def path_stats(self, path: str) -> dict[str, Any]:
        """Return how long the template is, and when the last of what it is made from was changed."""
        stats = dict(super().path_stats(path))
        stats["mtime"] = max(stats["mtime"], *(one.stat().st_mtime for one in self._made_with))
        return stats

    def source_to_code(  # type: ignore[override]  # a static method of the interface, though not of its classes
        self, data: Any, path: Any, **_: Any
    ) -> CodeType:
        """Compile the template, which is not kept as yet or was changed."""
        return self._environment.compile(bytes(data).decode(), self.name, str(path))
