"""What a run of a package needs: START's field ``package``, and the files as they follow in the frame's body."""

import re
from collections.abc import Mapping, Sequence
from typing import Any, Final

from grader.contracts.assignment import WantedPackage
from grader.contracts.package import PackageProblem
from grader.contracts.record import Record
from grader.contracts.upload import decoded
from grader.formats.packages.problems import problems, unread
from grader.formats.packages.workspace import Executable, Package, choose, read_packages

ANY_PACKAGE = WantedPackage()


_GENERATES: Final = re.compile(r"rosidl_generate_interfaces\s*\(([^)]*)\)")
_DEFINITION: Final = re.compile(r"\b((?:msg|srv|action)/\w+\.(?:msg|srv|action))\b")


class Mounted(Record):
    """A package ready to be run.

    Attributes:
        fields: START's ``package``. body: all files' contents, one after the other.
        chosen: what is run; None: nothing can be, or a launch file says what.
        file_name: path of the module that is run, in the archive. source: its text.
        problems: what is wrong with its files. unread: arguments of ``setup`` that only running it would tell.
        interfaces: definitions that CMake would generate, by place: ``my_msgs/msg/Name.msg``.
        texts: of all modules, by path.
    """

    fields: Mapping[str, Any]
    body: bytes
    chosen: Executable | None
    file_name: str
    source: str
    problems: tuple[PackageProblem, ...]
    unread: str
    texts: Mapping[str, str]
    interfaces: Mapping[str, str]


def mounted(source: bytes, wanted: WantedPackage | None, distro: str) -> Mounted:
    """Return a kept package as a run gets it. Raises RefusedError: it is none."""
    packages, files = read_packages(source)
    chosen = choose(packages, wanted or ANY_PACKAGE)
    order = sorted(files)
    site = "lib/python3.10/site-packages" if distro == "humble" else "lib/python3.12/site-packages"
    fields = {
        "files": [[path, len(files[path])] for path in order],
        "modules": [module for package in packages for module in _modules(package, site)],
        "shared": [shared for package in packages for shared in _shared(package, site)],
        "packages": {
            name: package.name for package in packages if package.is_built for name in package.marked
        },
        "executables": [
            [executable.package, executable.name, executable.module, executable.function]
            for package in packages
            for executable in package.executables
        ],
        "run": [] if chosen is None else [chosen.package, chosen.name],
        "launch": "" if wanted is None else wanted.launch,
    }
    path = "" if chosen is None else entry_path(packages, chosen)
    texts = {path: decoded(files[path]) for path in order if path.endswith(".py")}
    return Mounted(
        fields=fields,
        body=b"".join(files[path] for path in order),
        chosen=chosen,
        file_name=path,
        source=texts.get(path, ""),
        problems=problems(packages, files, wanted or ANY_PACKAGE),
        unread=unread(packages),
        texts=texts,
        interfaces=_interfaces(packages, files),
    )


def _interfaces(packages: Sequence[Package], files: Mapping[str, bytes]) -> dict[str, str]:
    """Return the definitions that packages of CMake would generate, by place: ``my_msgs/msg/Name.msg``."""
    modules = {}
    for package in packages:
        if not package.has_setup and "CMakeLists.txt" in package.paths:
            lists = decoded(files[f"{package.folder}/CMakeLists.txt"])
            generated = {
                definition for call in _GENERATES.findall(lists) for definition in _DEFINITION.findall(call)
            }
            for path in sorted(generated & set(package.paths)):
                modules[f"{package.name}/{path}"] = decoded(files[f"{package.folder}/{path}"])
    return modules


def entry_path(packages: Sequence[Package], chosen: Executable) -> str:
    """Return the path of an executable's module in the archive; empty where it is not installed."""
    for package in packages:
        if path := package.modules.get(chosen.module):
            return f"{package.folder}/{path}"
    return ""


def _modules(package: Package, site: str) -> list[list[Any]]:
    """Return name, path in the archive, whether it is a package, and installed path of each module."""
    if not package.is_built:
        return []
    modules: list[list[Any]] = []
    for name, path in package.modules.items():
        is_package = not path or path.endswith("/__init__.py")
        inside = f"install/{package.name}/{site}/" + name.replace(".", "/")
        installed = inside + ("/__init__.py" if is_package else ".py")
        modules.append([name, f"{package.folder}/{path}" if path else "", is_package, installed])
    return modules


def _shared(package: Package, site: str) -> list[list[str]]:
    """Return installed path and path in the archive of what ``data_files`` and ``package_data`` install."""
    if not package.is_built:
        return []
    prefix = f"install/{package.name}"
    placed = {**{f"{site}/{inside}": path for inside, path in package.data.items()}, **package.shared}
    return [[f"{prefix}/{target}", f"{package.folder}/{path}"] for target, path in placed.items()]
