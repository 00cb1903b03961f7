"""Which layers of isolation a host offers, and which files a confined process may read.

Both end in a `ZygoteConfig`, which is all that a zygote is told.
"""

import _socket
import importlib.util
import os
import sys
from collections.abc import Iterable, Mapping, Set
from pathlib import Path
from typing import Final

from grader.contracts.python import StrEnum
from grader.contracts.record import Record, field
from grader.jail import bounds, landlock, prepared_root, syscalls
from grader.jail.supervisor import ZygoteConfig

_CAP_SETGID, _CAP_SETUID = 6, 7
_EVERY_PACKAGE: Final = {**bounds.ALLOWED_PACKAGES, **bounds.PYBULLET_PACKAGES}


class Mode(StrEnum):
    """How much isolation is asked for.

    STRICT refuses to run without the required layers. BEST_EFFORT runs with what the host offers and names
    what is missing. DEV leaves out the kernel's confinement: for one's own code on one's own computer.
    """

    STRICT = "strict"
    BEST_EFFORT = "best-effort"
    DEV = "dev"


class Layer(StrEnum):
    """One independent means of keeping a script in."""

    PROCESS = "process"  # its own process, empty environment, four descriptors
    RLIMITS = "rlimits"
    SECCOMP = "seccomp"
    LANDLOCK = "landlock"
    OWN_UID = "own_uid"  # when the grader runs as root
    NAMESPACES = "namespaces"
    OWN_ROOT = "own_root"  # in Landlock's place: a directory prepared for hosts that have none


REQUIRED: Final = (Layer.PROCESS, Layer.RLIMITS, Layer.SECCOMP, Layer.LANDLOCK, Layer.OWN_UID)


class Program(Record):
    """What a zygote preloads and what its children run.

    Attributes:
        shim: directory that is all of a script's own import path.
        entry: ``module:function`` that a confined process calls with the channel's descriptor.
        preload: modules to import before the first fork.
        packages: those of third parties that a script may import, with the directories each needs.
    """

    shim: Path
    entry: str
    preload: tuple[str, ...] = ()
    packages: Mapping[str, tuple[str, ...]] = field(default_factory=lambda: bounds.ALLOWED_PACKAGES)


class LayerChoice(Record):
    """The layers that will be active and the required ones that cannot be."""

    active: tuple[Layer, ...]
    missing_required: tuple[Layer, ...]


def choose(mode: Mode, without: Set[Layer], shim: Path) -> LayerChoice:
    """Return the layers this host seems to offer, less `without`.

    Where Landlock is missing, a root directory prepared for `shim` takes its place, and that of namespaces.

    Only what can be told without trying: `Sandbox` then proves the layers from inside.
    """
    offered = {
        Layer.PROCESS: True,
        Layer.RLIMITS: True,
        Layer.SECCOMP: os.path.exists(syscalls.filter_path()),
        Layer.LANDLOCK: landlock.abi_version() > 0,
        Layer.OWN_UID: may_change_uid(),
        Layer.NAMESPACES: True,
        Layer.OWN_ROOT: False,
    }
    if sys.platform != "linux" or mode is Mode.DEV:
        offered = {layer: layer in (Layer.PROCESS, Layer.RLIMITS) for layer in offered}
    needed = [layer for layer in REQUIRED if layer is not Layer.OWN_UID or os.geteuid() == 0]
    landlocked = offered[Layer.LANDLOCK] and Layer.LANDLOCK not in without
    if mode is not Mode.DEV and not landlocked and offered[Layer.OWN_UID] and _has_prepared_root(shim):
        offered |= {Layer.OWN_ROOT: True, Layer.NAMESPACES: False}
        needed.remove(Layer.LANDLOCK)
    active = tuple(layer for layer, here in offered.items() if here and layer not in without)
    return LayerChoice(
        active=active, missing_required=tuple(layer for layer in needed if layer not in active)
    )


def _has_prepared_root(shim: Path) -> bool:
    return prepared_root.is_ready(*mounted_paths(shim, allowed_packages(_EVERY_PACKAGE)), prepared_root.PLACE)


def prepare_root(shim: Path) -> None:
    """Make the root directory that takes Landlock's place on this host.

    Raises OSError: it could not be made.
    """
    prepared_root.prepare(*mounted_paths(shim, allowed_packages(_EVERY_PACKAGE)), prepared_root.PLACE)


def configure(program: Program, active: tuple[Layer, ...]) -> ZygoteConfig:
    """Return the configuration of a zygote that runs `program` under `active` layers."""
    packages = allowed_packages(program.packages)
    landlocked = Layer.LANDLOCK in active
    readable = readable_paths(program.shim, packages) if landlocked else []
    shown, masked = mounted_paths(program.shim, packages)
    own_uid, own_root = Layer.OWN_UID in active, Layer.OWN_ROOT in active
    return ZygoteConfig(
        shim=str(program.shim.resolve()),
        entry=program.entry,
        preload=program.preload,
        packages=packages,
        readable=readable,
        shown=[*shown, *bounds.READABLE_DEVICES, *bounds.WRITABLE_DEVICES],
        masked=masked,
        landlock=landlocked,
        seccomp=Layer.SECCOMP in active,
        namespaces=Layer.NAMESPACES in active,
        box_uid=box_uid() if own_uid else None,
        keep_read=own_uid and not own_root and not reachable_by_others(shown),
        root=str(prepared_root.PLACE) if own_root else None,
    )


def may_change_uid() -> bool:
    """Return whether this process may give another user id to a child."""
    try:
        status = Path("/proc/self/status").read_text(encoding="ascii")
    except OSError:
        return False
    effective = next(int(line.split()[1], 16) for line in status.splitlines() if line.startswith("CapEff"))
    needed = 1 << _CAP_SETGID | 1 << _CAP_SETUID
    return os.geteuid() == 0 and effective & needed == needed


def box_uid() -> int:
    """Return a user id that nothing else on this host uses: one per grading process."""
    with open("/proc/self/uid_map", encoding="ascii") as file:
        spans = [tuple(map(int, line.split())) for line in file]
    uid = bounds.BOX_UID_BASE + os.getpid()
    if any(first <= uid < first + count for first, _, count in spans):
        return uid
    return bounds.BOX_UID_BASE_MAPPED + os.getpid() % bounds.BOX_UID_COUNT_MAPPED


# ------------------------------------------------------------------------------------------------- files


def allowed_packages(names: Iterable[str] = bounds.ALLOWED_PACKAGES) -> dict[str, str]:
    """Return name -> directory of the third-party packages `names`, as far as installed."""
    folders: dict[str, str] = {}
    for name in names:
        spec = importlib.util.find_spec(name)
        if spec is not None and spec.submodule_search_locations:
            folders[name] = os.path.realpath(spec.submodule_search_locations[0])
    return folders


def standard_library() -> str:
    """Return the directory of the standard library that runs this process."""
    return os.path.dirname(os.path.realpath(os.__file__))


def readable_paths(shim: Path, packages: dict[str, str]) -> list[str]:
    """Return all files and directories that confined processes may read.

    The standard library is listed entry by entry, because many installations keep site-packages, and so
    the grader and the reference solutions, inside its directory.
    """
    with os.scandir(standard_library()) as entries:
        stdlib = sorted(entry.path for entry in entries if entry.name not in bounds.STDLIB_EXCLUDED)
    return _existing([str(shim.resolve()), *stdlib, *_outside_stdlib(packages)])


def mounted_paths(shim: Path, packages: dict[str, str]) -> tuple[list[str], list[str]]:
    """Return what the minimal root shows, and which directories in it are covered by empty ones.

    Coarser than `readable_paths`, which applies within it as well: each entry costs a mount.
    """
    directory = standard_library()
    masked = [os.path.join(directory, name) for name in sorted(bounds.STDLIB_EXCLUDED)]
    return (
        _existing([directory, str(shim.resolve()), *_outside_stdlib(packages)]),
        [path for path in masked if os.path.isdir(path)],
    )


def _outside_stdlib(packages: dict[str, str]) -> list[str]:
    extensions = getattr(_socket, "__file__", None)  # the directory of extension modules, unless built in
    paths = [os.path.dirname(os.path.realpath(extensions))] if extensions else []
    for name, directory in packages.items():
        parent = os.path.dirname(directory)
        paths += [os.path.join(parent, part) for part in _EVERY_PACKAGE[name]]
    return [*paths, *_library_directories()]


def _library_directories() -> list[str]:
    """Return the directories of shared libraries; entry by entry where one holds Python packages as well."""
    paths: list[str] = []
    for directory in filter(os.path.isdir, bounds.SHARED_LIBRARY_DIRECTORIES):
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
