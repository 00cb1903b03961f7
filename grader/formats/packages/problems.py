"""What is wrong with a package, found without running anything of it: the mistakes that beginners make.

Each would show at home as well: colcon does not build the package, ``ros2 run`` does not find the executable, its
start ends with an exception, or ``ros2 launch`` does not find a file.
"""

import ast
import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from typing import Final

from grader.contracts.assignment import WantedPackage
from grader.contracts.package import ENTRY, MANIFEST, MODULES, NAMES, SHARE, PackageProblem
from grader.formats.packages.setup_file import parsed
from grader.formats.packages.workspace import PYTHON, Executable, Package, choose

_IMPORT: Final = re.compile(r"^[ \t]*(?:from|import)[ \t]+([a-z]\w*)", re.MULTILINE)
_OF_ROS: Final = re.compile(
    r"rclpy|\w+_msgs|\w+_interfaces|std_srvs|tf2_ros|tf_transformations|cv_bridge|turtlesim"
)
_TO_INSTALL: Final = re.compile(
    r"(?:.*/)?(?:[^/]+[._]launch\.(?:py|xml|yaml)|(?:launch|config|params?)/[^/]+\.(?:py|yaml|yml|xml))"
)
_MOST_READ: Final = 20
"""Modules that are parsed to see whether they have what entries name: work of the grader, not of the script."""
_MOST_LOOKED_AT, _MOST_SHOWN = 200, 20
_TESTS: Final = ("test/", "tests/")


def problems(
    packages: Sequence[Package], files: Mapping[str, bytes], wanted: WantedPackage
) -> tuple[PackageProblem, ...]:
    """Return what is wrong, the first cause first; of several packages in the one that is wanted, or in all."""
    looked_at = [
        package for package in packages if wanted.name and wanted.name in (package.name, package.setup_name)
    ]
    looked_at = looked_at or [package for package in packages if not _is_cpp(package)] or list(packages)
    chosen = choose(packages, wanted)
    every = (problem for package in looked_at for problem in _of_package(package, files, chosen))
    found = list(islice(every, _MOST_LOOKED_AT))
    found += _unmatched(looked_at, wanted, found)
    return tuple(sorted(found, key=lambda problem: not problem.fatal)[:_MOST_SHOWN])


def unread(packages: Sequence[Package]) -> str:
    """Return which arguments of ``setup`` only running it would tell; nothing where all could be read."""
    return ", ".join(dict.fromkeys(name for package in packages for name in package.unread))


def _is_cpp(package: Package) -> bool:
    """Whether a package of a workspace is none of Python, and none that was to be."""
    return not package.has_setup and "CMakeLists.txt" in package.paths


def _of_package(
    package: Package, files: Mapping[str, bytes], chosen: Executable | None
) -> Iterator[PackageProblem]:
    yield from _manifest(package, files)
    if not package.has_setup:
        yield _fatal("package_setup_missing", MODULES, folder=package.folder)
        return
    if "setup" in package.unread or "entry_points" in package.unread:
        yield _fatal(
            "package_setup_unread", MODULES if "setup" in package.unread else ENTRY, folder=package.folder
        )
        return
    yield from _names(package)
    yield from _config(package)
    yield from _entries(package)
    names_by_package: dict[str, set[str] | None] = {}
    run = [script for script in package.scripts if chosen is None or script.name == chosen.name]
    for script in run:  # nobody starts the others
        yield from _script(package, script, files, names_by_package)
    yield from _shared(package)


def _manifest(package: Package, files: Mapping[str, bytes]) -> Iterator[PackageProblem]:
    manifest = package.manifest
    if manifest is None:
        yield _fatal("package_manifest_missing", MANIFEST, folder=package.folder)
    elif manifest.trouble or not manifest.name:
        yield _fatal(
            "package_manifest_broken", MANIFEST, folder=package.folder, reason=manifest.trouble or "<name>"
        )
    elif manifest.build_type != PYTHON:
        yield _fatal("package_build_type", MANIFEST, folder=package.folder, given=manifest.build_type or "—")
    else:
        missing = sorted(_imported(package, files) - {*manifest.depends, package.name})
        if missing:
            lines = " ".join(f"<depend>{name}</depend>" for name in missing)
            yield _harmless("package_depend", MANIFEST, names=", ".join(missing), lines=lines)


def _imported(package: Package, files: Mapping[str, bytes]) -> set[str]:
    modules: set[str] = set()
    for path in package.paths:
        if path.endswith(".py") and path != "setup.py" and not path.startswith((*_TESTS, "launch/")):
            text = files[f"{package.folder}/{path}"].decode("utf-8", "replace")
            modules.update(name for name in _IMPORT.findall(text) if _OF_ROS.fullmatch(name))
    return modules


def _names(package: Package) -> Iterator[PackageProblem]:
    name = package.name
    owner = package.script_folder.removeprefix("lib/")
    others = {"setup.py": package.setup_name, "setup.cfg": owner if package.script_folder != "bin" else name}
    wrong = [f"{file}: {other}" for file, other in others.items() if other != name]
    if package.manifest is not None and package.manifest.name and wrong:
        runs = bool(package.executables)  # under the name in the index
        values = {"name": name, "others": "; ".join(wrong)}
        yield PackageProblem("package_name_differs", NAMES, not runs, values)
    elif package.is_built and name not in package.marked:
        yield _fatal("package_marker", NAMES, name=name)


def _config(package: Package) -> Iterator[PackageProblem]:
    if not package.has_config:
        yield _fatal("package_config_missing", ENTRY, name=package.name)
    elif not package.script_folder.startswith("lib/"):
        yield _fatal("package_config_wrong", ENTRY, name=package.name)


def _entries(package: Package) -> Iterator[PackageProblem]:
    well_formed = {(script.name, script.module, script.function) for script in package.scripts}
    for line in package.entries:
        if line.count("=") > 1:
            yield _fatal("package_entry_joined", ENTRY, line=line[:100])
        elif tuple(part.strip() for part in re.split("[=:]", line)) not in well_formed:
            yield _fatal("package_entry_malformed", ENTRY, line=line[:100], name=package.name)
    if not package.entries:
        yield _fatal("package_entry_missing", ENTRY, name=package.name)


def _script(
    package: Package, script: Executable, files: Mapping[str, bytes], known: dict[str, set[str] | None]
) -> Iterator[PackageProblem]:
    """Yield what is wrong with an entry; `known` holds the names of the modules that were read for others."""
    path = package.modules.get(script.module)
    beside = package.sources + script.module.replace(".", "/") + ".py"
    folder = beside.rpartition("/")[0]
    if path is None and beside in package.paths and f"{folder}/__init__.py" not in package.paths:
        yield _fatal("package_no_init", MODULES, folder=f"{package.folder}/{folder}")
    elif path is None and beside in package.paths:
        yield _fatal("package_module_not_installed", MODULES, module=script.module.rpartition(".")[0])
    elif path is None:
        there = sorted(name for name in package.modules if not name.endswith("__init__") and "." in name)
        listed = ", ".join(there[:5]) or "—"
        yield _fatal("package_entry_module", ENTRY, module=script.module, there=listed, entry=script.name)
    elif path:
        if path not in known and len(known) < _MOST_READ:
            known[path] = _defined(files[f"{package.folder}/{path}"])
        names = known.get(path)
        if names is not None and script.function.partition(".")[0] not in names:
            yield _fatal(
                "package_entry_function", ENTRY, module=script.module, function=script.function, file=path
            )


def _defined(source: bytes) -> set[str] | None:
    """Return the names that a module binds at its top; None where only running it would tell."""
    tree = parsed(source)
    if tree is None:
        return None
    names: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            names.add(node.name)
        elif isinstance(node, ast.Import | ast.ImportFrom):
            if any(name.name == "*" for name in node.names):
                return None
            names.update((name.asname or name.name).partition(".")[0] for name in node.names)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            names.add(node.id)
    return names


def _shared(package: Package) -> Iterator[PackageProblem]:
    if "data_files" in package.unread:
        return
    installed = {*package.shared.values(), *package.data.values()}
    if "package.xml" in package.paths and "package.xml" not in installed:
        yield _harmless(
            "package_share_missing",
            SHARE,
            file="package.xml",
            name=package.name,
            folder="",
            pattern="package.xml",
        )
    for path in package.paths:
        if path not in installed and _TO_INSTALL.fullmatch(path) and not path.startswith(_TESTS):
            folder, _, last = path.rpartition("/")
            pattern = f"{folder}/*{last[last.find('.') :]}" if folder else last
            yield _harmless(
                "package_share_missing",
                SHARE,
                file=path,
                name=package.name,
                folder=f"/{folder}",
                pattern=pattern,
            )
            return


def _unmatched(
    packages: Sequence[Package], wanted: WantedPackage, found: Sequence[PackageProblem]
) -> Iterator[PackageProblem]:
    """Yield why nothing is run of packages without another fatal mistake."""
    if any(problem.fatal for problem in found):
        return
    every = sorted({executable.name for package in packages for executable in package.executables})
    if wanted.name and all(package.name != wanted.name for package in packages):
        names = ", ".join(package.name for package in packages)
        yield _fatal("package_other_name", NAMES, name=wanted.name, given=names)
    elif wanted.launch and not any(
        path.rpartition("/")[2] == wanted.launch for package in packages for path in package.shared
    ):
        yield _fatal("package_launch_missing", SHARE, name=wanted.launch)
    elif not wanted.launch and choose(packages, wanted) is None:
        code = "package_entry_other" if wanted.executable else "package_entry_several"
        yield _fatal(code, ENTRY, wanted=wanted.executable, given=", ".join(every) or "—")


def _fatal(code: str, area: str, **values: str) -> PackageProblem:
    return PackageProblem(code, area, True, values)


def _harmless(code: str, area: str, **values: str) -> PackageProblem:
    return PackageProblem(code, area, False, values)
