"""Choose the layers of isolation for this host and this mode."""

import os
import sys
from collections.abc import Set
from enum import StrEnum
from pathlib import Path
from typing import Final

from grader.contracts.record import record
from grader.jail import landlock, layout, libc, policy
from grader.jail.supervisor import FILTER_DIRECTORY, ZygoteConfig

_CAP_SETGID, _CAP_SETUID = 6, 7


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


REQUIRED: Final = (Layer.PROCESS, Layer.RLIMITS, Layer.SECCOMP, Layer.LANDLOCK, Layer.OWN_UID)


@record
class Program:
    """What a zygote preloads and what its children run.

    Attributes:
        shim: directory that is all of a script's own import path.
        entry: ``module:function`` that a confined process calls with the channel's descriptor.
        preload: modules to import before the first fork.
    """

    shim: Path
    entry: str
    preload: tuple[str, ...] = ()


@record
class Choice:
    """The layers that will be active and the required ones that cannot be."""

    active: tuple[Layer, ...]
    missing_required: tuple[Layer, ...]


def choose(mode: Mode, without: Set[Layer]) -> Choice:
    """Return the layers this host seems to offer, less `without`.

    Only what can be told without trying: `Sandbox` then proves the layers from inside.
    """
    offered = {
        Layer.PROCESS: True,
        Layer.RLIMITS: True,
        Layer.SECCOMP: (FILTER_DIRECTORY / f"{libc.MACHINE}.bpf").exists(),
        Layer.LANDLOCK: landlock.abi_version() > 0,
        Layer.OWN_UID: may_change_uid(),
        Layer.NAMESPACES: True,
    }
    if sys.platform != "linux" or mode is Mode.DEV:
        offered = {layer: layer in (Layer.PROCESS, Layer.RLIMITS) for layer in offered}
    active = tuple(layer for layer, here in offered.items() if here and layer not in without)
    needed = [layer for layer in REQUIRED if layer is not Layer.OWN_UID or os.geteuid() == 0]
    return Choice(active=active, missing_required=tuple(layer for layer in needed if layer not in active))


def configure(program: Program, active: tuple[Layer, ...]) -> ZygoteConfig:
    """Return what a zygote must be told to run `program` under `active` layers."""
    packages = layout.allowed_packages()
    landlocked = Layer.LANDLOCK in active
    readable = layout.readable_paths(program.shim, packages) if landlocked else []
    shown, masked = layout.mounted_paths(program.shim, packages)
    own_uid = Layer.OWN_UID in active
    return ZygoteConfig(
        shim=str(program.shim.resolve()),
        entry=program.entry,
        preload=program.preload,
        packages=packages,
        readable=readable,
        shown=[*shown, *policy.READABLE_DEVICES, *policy.WRITABLE_DEVICES],
        masked=masked,
        landlock=landlocked,
        seccomp=Layer.SECCOMP in active,
        namespaces=Layer.NAMESPACES in active,
        box_uid=box_uid() if own_uid else None,
        keep_read=own_uid and not layout.reachable_by_others(shown),
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
    """Return a user id that no one else on this host has: one per grading process."""
    with open("/proc/self/uid_map", encoding="ascii") as file:
        spans = [tuple(map(int, line.split())) for line in file]
    wanted = policy.BOX_UID_BASE + os.getpid()
    if any(first <= wanted < first + count for first, _, count in spans):
        return wanted
    return policy.BOX_UID_BASE_MAPPED + os.getpid() % policy.BOX_UID_COUNT_MAPPED
