"""What a ``setup.py`` says, read from its syntax tree: it is a program, and never executed to find out.

Understood are literals, names bound to them, f-strings, ``+``, ``os.path.join``, ``glob``, ``find_packages``,
``list.append`` and ``list.extend``: what ``ros2 pkg create`` and its readers write. Anything else is `UNKNOWN`.
"""

import ast
from collections.abc import Collection, Mapping, Sequence
from fnmatch import fnmatchcase
from functools import cached_property
from typing import Any, Final

UNKNOWN: Final = object()
"""Stands for a value that only running the file would tell."""

_MOST_BYTES: Final = 64 * 1024
_MOST_DEPTH: Final = 60
_LONGEST_LINE: Final = 4_000
_LONGEST_VALUE: Final = 4_000
_MOST_STEPS: Final = 200_000
"""Names of paths that all searches of a file may compare with names of patterns; sums count, too. A package of 500
files four folders deep takes 6,000 for a pattern. This is work of the grader, not of the script: without a bound
4,000 lines of ``glob("**/*")`` took ten minutes."""
_COPIED_IN_A_STEP: Final = 16


class SetupFile:
    """The keyword arguments that a ``setup.py`` gives to ``setup``, as far as they can be read.

    Attributes:
        arguments: by name; a value may be, or hold, `UNKNOWN`.
        calls_setup: whether there is a call of ``setup`` at all.
        is_python: whether the file could be parsed.
    """

    def __init__(self, source: bytes, paths: Collection[str]) -> None:
        """Read `source`; `paths` are the package's files, relative to its folder."""
        self.arguments: dict[str, Any] = {}
        self.calls_setup = False
        self._paths = sorted(paths)
        self._names: dict[str, Any] = {}
        self._steps_left = _MOST_STEPS
        tree = parsed(source)
        self.is_python = tree is not None
        try:
            for statement in [] if tree is None else tree.body:
                self._execute(statement)
        except RecursionError:
            self.arguments, self.is_python = {}, False

    def text(self, name: str) -> str:
        """Return an argument that is a text; empty when it is not given, or not known."""
        value = self.arguments.get(name)
        return value if isinstance(value, str) else ""

    def strings(self, name: str) -> list[str] | None:
        """Return an argument that is a list of texts; None when it is not known."""
        value = self.arguments.get(name, [])
        if isinstance(value, list | tuple) and all(isinstance(element, str) for element in value):
            return list(value)
        return None

    def console_scripts(self) -> list[str] | None:
        """Return the lines of the group ``console_scripts``; None when they are not known."""
        points = self.arguments.get("entry_points", {})
        if isinstance(points, str):
            points = _sections(points)
        if not isinstance(points, dict):
            return None
        lines = points.get("console_scripts", [])
        if isinstance(lines, str):
            lines = [line.strip() for line in lines.splitlines() if line.strip()]
        if isinstance(lines, list | tuple) and all(isinstance(line, str) for line in lines):
            return list(lines)
        return None

    def data_files(self) -> list[tuple[str, list[str]]] | None:
        """Return (target folder, files) as far as it is known; None when nothing is."""
        value = self.arguments.get("data_files", [])
        if not isinstance(value, list | tuple):
            return None
        targets: list[tuple[str, list[str]]] = []
        for element in value:
            if not (isinstance(element, list | tuple) and len(element) == 2 and isinstance(element[0], str)):
                return None
            files = element[1]
            if not (isinstance(files, list | tuple) and all(isinstance(file, str) for file in files)):
                return None
            targets.append((element[0], list(files)))
            if sum(len(paths) for _, paths in targets) > _LONGEST_VALUE:
                return None
        return targets

    def package_dir(self) -> dict[str, str] | None:
        """Return the folders of packages by their names, of all others under the empty one; None: not known."""
        value = self.arguments.get("package_dir", {})
        if isinstance(value, dict) and all(isinstance(element, str) for element in value.values()):
            return {name: _plain(folder) for name, folder in value.items()}
        return None

    def package_data(self, folders: Mapping[str, str]) -> dict[str, list[str]] | None:
        """Return which files are installed with the modules of packages; None when that is not known.

        Args:
            folders: of all packages that are installed, by their names.
        """
        value = self.arguments.get("package_data", {})
        if not isinstance(value, dict):
            return None
        installed: dict[str, list[str]] = {}
        for name, folder in folders.items():
            for patterns in (value.get("", []), value.get(name, [])):
                if not (isinstance(patterns, list) and all(isinstance(each, str) for each in patterns)):
                    return None
                for pattern in patterns:
                    paths = self._globbed(f"{folder}/{pattern}" if folder else pattern)
                    if paths is UNKNOWN:
                        return None
                    installed.setdefault(name, []).extend(paths)
        return installed

    def _execute(self, statement: ast.stmt) -> None:
        if isinstance(statement, ast.Assign):
            value = self._value(statement.value)
            for target in statement.targets:
                if isinstance(target, ast.Name):
                    self._names[target.id] = value
        elif isinstance(statement, ast.AnnAssign) and isinstance(statement.target, ast.Name):
            self._names[statement.target.id] = (
                UNKNOWN if statement.value is None else self._value(statement.value)
            )
        elif isinstance(statement, ast.AugAssign) and isinstance(statement.target, ast.Name):
            name = statement.target.id
            self._names[name] = self._sum(self._names.get(name, UNKNOWN), self._value(statement.value))
        elif isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Call):
            self._call(statement.value)
        elif isinstance(statement, ast.If) and _is_main_guard(statement.test):
            for inner in statement.body:
                self._execute(inner)
        else:
            self._forget(statement)

    def _forget(self, statement: ast.stmt) -> None:
        """Take every name that another kind of statement may change for unknown."""
        for node in ast.walk(statement):
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
                self._names[node.id] = UNKNOWN
            elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
                owner = node.func.value
                if isinstance(owner, ast.Name) and owner.id in self._names:
                    self._names[owner.id] = UNKNOWN
            if isinstance(node, ast.Call) and _name_of(node.func) == "setup":
                self._take_arguments(node)

    def _call(self, call: ast.Call) -> None:
        function = call.func
        if _name_of(function) == "setup":
            self._take_arguments(call)
        elif isinstance(function, ast.Attribute) and isinstance(function.value, ast.Name):
            module = self._names.get(function.value.id)
            if isinstance(module, list) and function.attr in ("append", "extend") and len(call.args) == 1:
                value = self._value(call.args[0])
                added = [value] if function.attr == "append" else value
                self._names[function.value.id] = self._sum(module, added)

    def _take_arguments(self, call: ast.Call) -> None:
        self.calls_setup = True
        for keyword in call.keywords:
            value = self._value(keyword.value)
            if keyword.arg is not None:
                self.arguments[keyword.arg] = value
            elif isinstance(value, dict):
                self.arguments.update({str(name): each for name, each in value.items()})

    def _value(self, node: ast.expr) -> Any:
        if isinstance(node, ast.Constant):
            return node.value
        if isinstance(node, ast.Name):
            return self._names.get(node.id, UNKNOWN)
        if isinstance(node, ast.List | ast.Tuple):
            return self._elements(node.elts)
        if isinstance(node, ast.Dict):
            return self._dict(node)
        if isinstance(node, ast.JoinedStr):
            return self._joined(node)
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
            return self._sum(self._value(node.left), self._value(node.right))
        if isinstance(node, ast.Call):
            return self._called(node)
        return UNKNOWN

    def _elements(self, nodes: Sequence[ast.expr]) -> Any:
        elements: list[Any] = []
        for node in nodes:
            if isinstance(node, ast.Starred):
                more = self._value(node.value)
                if not isinstance(more, list):
                    return UNKNOWN
                elements += more
                if len(elements) > _LONGEST_VALUE:
                    return UNKNOWN
            else:
                elements.append(self._value(node))
        return elements

    def _dict(self, node: ast.Dict) -> Any:
        values = {}
        for key, value in zip(node.keys, node.values, strict=True):
            name = UNKNOWN if key is None else self._value(key)
            if not isinstance(name, str):
                return UNKNOWN
            values[name] = self._value(value)
        return values

    def _joined(self, node: ast.JoinedStr) -> Any:
        text = ""
        for part in node.values:
            value = self._value(part.value if isinstance(part, ast.FormattedValue) else part)
            if not isinstance(value, str):
                return UNKNOWN
            text += value
        return _bounded(text)

    def _called(self, call: ast.Call) -> Any:
        name = _name_of(call.func)
        arguments = [self._value(arg) for arg in call.args]
        options = {
            keyword.arg: self._value(keyword.value) for keyword in call.keywords if keyword.arg is not None
        }
        if name == "find_packages":
            return self._found_packages(arguments, options)
        if name in ("glob", "iglob", "join", "str", "list", "sorted") and arguments:
            if name == "glob" and isinstance(arguments[0], str):
                return self._globbed(arguments[0])
            if name == "join" and all(isinstance(argument, str) for argument in arguments):
                return _bounded(_joined_path(arguments))
            return arguments[0] if name in ("str", "list", "sorted") else UNKNOWN
        return UNKNOWN

    def _found_packages(self, arguments: list[Any], options: Mapping[str, Any]) -> Any:
        values = {**dict(zip(("where", "exclude", "include"), arguments, strict=False)), **options}
        where, excluded = values.get("where", "."), values.get("exclude", [])
        included = values.get("include", ["*"])
        if not (isinstance(where, str) and isinstance(excluded, list) and isinstance(included, list)):
            return UNKNOWN
        if not self._may(self._names_of_paths * (1 + len(excluded) + len(included))):
            return UNKNOWN
        start = f"{_plain(where)}/".removeprefix("/")
        folders = {
            path.rpartition("/")[0][len(start) :]
            for path in self._paths
            if path.endswith("/__init__.py") and path.startswith(start) and "/" in path[len(start) :]
        }
        packages = []
        for folder in sorted(folders):
            parts = folder.split("/")
            whole = all("/".join(parts[:end]) in folders for end in range(1, len(parts)))
            name = ".".join(parts)
            fits = any(fnmatchcase(name, str(pattern)) for pattern in included)
            if whole and fits and not any(fnmatchcase(name, str(pattern)) for pattern in excluded):
                packages.append(name)
        return packages

    def _globbed(self, pattern: str) -> Any:
        """Return the files and folders that match, as `glob.glob` does in the package's folder."""
        pattern_names = pattern.removeprefix("./").split("/")
        if not self._may(self._names_of_paths * len(pattern_names)):
            return UNKNOWN
        return _bounded([path for path in self._every if _matches(path.split("/"), pattern_names)])

    @cached_property
    def _every(self) -> list[str]:
        """All files and folders of the package."""
        return sorted(
            {"/".join(path.split("/")[:end]) for path in self._paths for end in range(1, path.count("/") + 2)}
        )

    @cached_property
    def _names_of_paths(self) -> int:
        return sum(path.count("/") + 1 for path in self._every)

    def _sum(self, left: Any, right: Any) -> Any:
        alike = (isinstance(left, str) and isinstance(right, str)) or (
            isinstance(left, list) and isinstance(right, list)
        )
        if not alike or not self._may((len(left) + len(right)) // _COPIED_IN_A_STEP):
            return UNKNOWN
        return _bounded(left + right)

    def _may(self, steps: int) -> bool:
        """Count `steps`; return whether the file is still within its bound."""
        self._steps_left -= steps
        return self._steps_left >= 0


def parsed(source: bytes) -> ast.Module | None:
    """Return the syntax tree; None of what is no Python, or nested so deeply that reading it is not safe."""
    depth = deepest = 0
    for byte in source:
        depth += (byte in b"([{") - (byte in b")]}")
        deepest = max(deepest, depth)
    longest = max(map(len, source.splitlines()), default=0)
    if len(source) > _MOST_BYTES or deepest > _MOST_DEPTH or longest > _LONGEST_LINE or b"\0" in source:
        return None
    try:
        return ast.parse(source)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None


def _bounded(value: Any) -> Any:
    """Return a text or list unless it is longer than people write them: names can double it line by line."""
    return value if len(value) <= _LONGEST_VALUE else UNKNOWN


def _name_of(function: ast.expr) -> str:
    if isinstance(function, ast.Attribute):
        return function.attr
    return function.id if isinstance(function, ast.Name) else ""


def _is_main_guard(test: ast.expr) -> bool:
    return isinstance(test, ast.Compare) and isinstance(test.left, ast.Name) and test.left.id == "__name__"


def _plain(folder: str) -> str:
    """Return a folder of the package without dots and slashes around it; empty: the package's own."""
    return "/".join(part for part in folder.split("/") if part not in ("", "."))


def _joined_path(parts: Sequence[str]) -> str:
    path = ""
    for part in parts:
        path = part if part.startswith("/") or not path else f"{path.rstrip('/')}/{part}"
    return path


def _matches(parts: Sequence[str], wanted: Sequence[str]) -> bool:
    """Whether a path fits a pattern; ``**`` stands for any number of folders. Linear in both."""
    reached = {0}  # how many names of the pattern the path so far may stand for
    for part in (*parts, None):
        for at in range(len(wanted)):
            if at in reached and wanted[at] == "**":
                reached.add(at + 1)
        if part is None:
            return len(wanted) in reached
        reached = {
            at + (wanted[at] != "**")
            for at in reached
            if at < len(wanted) and (wanted[at] == "**" or _fits(part, wanted[at]))
        }
    return False


def _fits(name: str, pattern: str) -> bool:
    hidden = name.startswith(".") and not pattern.startswith(".")
    return not hidden and fnmatchcase(name, pattern)


def _sections(text: str) -> dict[str, str]:
    """Return the sections of entry points that are written as the text of an INI file."""
    sections: dict[str, str] = {}
    section = ""
    for line in text.splitlines():
        if line.strip().startswith("[") and line.strip().endswith("]"):
            section = line.strip()[1:-1].strip()
            sections.setdefault(section, "")
        elif section:
            sections[section] += f"{line}\n"
    return sections
