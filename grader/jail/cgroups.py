"""What control groups bound this process from outside: read only, nothing is created or moved.

The sandbox makes no groups of its own (docs/sandbox.md, "Choices"); the one that the service manager or the
container engine has put the grader into is the bound that holds for all slots together.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

PROC: Final = Path("/proc/self")
_NO_LIMIT_V1: Final = 1 << 60
"""Version 1 writes "no limit" as a number near 2**63."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Bound:
    """The smallest limits of this process's group and the groups around it.

    Attributes:
        version: of the hierarchy that has the limits; 0: none is mounted.
        memory_bytes, tasks: None without a limit. Tasks are processes and threads.
    """

    version: int = 0
    memory_bytes: int | None = None
    tasks: int | None = None


def own_bound(proc: Path = PROC) -> Bound:
    """Return what bounds this process; on a host without control groups, nothing."""
    try:
        mounts = list(_mounts((proc / "mountinfo").read_text(encoding="utf-8")))
        groups = dict(_groups((proc / "cgroup").read_text(encoding="utf-8")))
    except OSError:
        return Bound()
    limits: dict[str, int | None] = {}
    bound = Bound()
    for version, controller, name in (
        (1, "memory", "memory.limit_in_bytes"), (1, "pids", "pids.max"),
        (2, "memory", "memory.max"), (2, "pids", "pids.max"),
    ):  # fmt: skip
        kind = controller if version == 1 else ""
        point = next((mount for mount in mounts if mount[0] == version and kind in mount[1]), None)
        if point is None or kind not in groups or controller in limits:
            continue
        directories = _directories(*point[2:], groups[kind])
        values = [value for directory in directories if (value := _limit(directory / name)) is not None]
        if version == 2 and not (directories[0] / name).exists() and not values:
            continue  # the controller is bound to version 1, or switched off here
        limits[controller] = min(values, default=None)
        bound = Bound(version=version, memory_bytes=limits.get("memory"), tasks=limits.get("pids"))
    return bound


def _mounts(mountinfo: str) -> Iterator[tuple[int, set[str], str, str]]:
    """Give (version, controllers, root, mount point) of each mounted hierarchy; see proc(5)."""
    for line in mountinfo.splitlines():
        fields, _, rest = line.partition(" - ")
        root, point = fields.split()[3:5]
        kind, _, options = rest.split(maxsplit=2)
        if kind == "cgroup":
            yield 1, set(options.split(",")), root, point
        elif kind == "cgroup2":
            yield 2, {""}, root, point


def _groups(cgroup: str) -> Iterator[tuple[str, str]]:
    """Give (controller, path) of this process's groups; the empty controller stands for version 2."""
    for line in cgroup.splitlines():
        _, controllers, path = line.split(":", 2)
        for controller in controllers.split(","):
            yield controller, path


def _directories(root: str, point: str, path: str) -> list[Path]:
    """Return the group's directory and those around it, as far as they can be seen from here."""
    below = path[len(root) :] if root != "/" and path.startswith(root) else path
    own = Path(point, below.lstrip("/"))
    if ".." in own.parts or not own.is_dir():
        own = Path(point)  # another namespace's view of the path
    return [own, *(parent for parent in own.parents if parent.is_relative_to(point))]


def _limit(path: Path) -> int | None:
    try:
        value = int(path.read_text(encoding="ascii"))
    except (OSError, ValueError):
        return None  # no such limit, or "max"
    return value if value < _NO_LIMIT_V1 else None
