"""Which files of this installation a confined process may read."""

import _socket
import importlib.util
import os
from pathlib import Path

from grader.jail import policy


def allowed_packages() -> dict[str, str]:
    """Return name -> directory of the third-party packages a script may import, as far as installed."""
    found: dict[str, str] = {}
    for name in policy.ALLOWED_PACKAGES:
        spec = importlib.util.find_spec(name)
        if spec is not None and spec.submodule_search_locations:
            found[name] = os.path.realpath(spec.submodule_search_locations[0])
    return found


def standard_library() -> str:
    """Return the directory of the standard library that runs this process."""
    return os.path.dirname(os.path.realpath(os.__file__))


def readable_paths(shim: Path, packages: dict[str, str]) -> list[str]:
    """Return the files and directories that confined processes may read, and nothing beside them.

    The standard library is listed entry by entry, because many installations keep site-packages, and so
    the grader and the reference solutions, inside its directory.
    """
    with os.scandir(standard_library()) as entries:
        stdlib = sorted(entry.path for entry in entries if entry.name not in policy.STDLIB_EXCLUDED)
    return _existing([str(shim.resolve()), *stdlib, *_outside_stdlib(packages)])


def mounted_paths(shim: Path, packages: dict[str, str]) -> tuple[list[str], list[str]]:
    """Return what the minimal root shows, and which directories in it are covered by empty ones.

    Coarser than `readable_paths`, which applies within it as well: each entry costs a mount.
    """
    directory = standard_library()
    masked = [os.path.join(directory, name) for name in sorted(policy.STDLIB_EXCLUDED)]
    return (
        _existing([directory, str(shim.resolve()), *_outside_stdlib(packages)]),
        [path for path in masked if os.path.isdir(path)],
    )


def _outside_stdlib(packages: dict[str, str]) -> list[str]:
    extensions = getattr(_socket, "__file__", None)  # the directory of extension modules, unless built in
    paths = [os.path.dirname(os.path.realpath(extensions))] if extensions else []
    for name, directory in packages.items():
        parent = os.path.dirname(directory)
        paths += [os.path.join(parent, part) for part in policy.ALLOWED_PACKAGES[name]]
    return [*paths, *_library_directories()]


def _library_directories() -> list[str]:
    """Return the directories of shared libraries; entry by entry where one holds Python packages as well."""
    paths: list[str] = []
    for directory in filter(os.path.isdir, policy.SHARED_LIBRARY_DIRECTORIES):
        names = os.listdir(directory) if directory.endswith("/lib64") else []
        if any(name.startswith("python") for name in names):
            paths += [
                os.path.join(directory, name) for name in sorted(names) if not name.startswith("python")
            ]
        else:
            paths.append(directory)
    return paths


def _existing(paths: list[str]) -> list[str]:
    return [path for path in dict.fromkeys(paths) if os.path.exists(path)]


def reachable_by_others(paths: list[str]) -> bool:
    """Return whether any user may pass through the directories that lead to `paths`."""
    directories = {parent for path in paths for parent in Path(path).parents}
    return all(directory.stat().st_mode & 0o001 for directory in directories)
