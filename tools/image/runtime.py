"""Run an image's file system with what Docker restricts in an ordinary container, by the runtime Docker uses.

Docker's daemon is root and its containers' processes are not, in no user namespace: so are these when we are
root. For an ordinary user all of it happens in a user namespace, and control groups' limits are left out.
"""

import itertools
import json
import os
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from tools.image import unprivileged
from tools.image.build import Image

UID: Final = 1000
MEMORY_BYTES: Final = 2 * 1024**3
TASKS: Final = 512

_NUMBERS: Final = itertools.count(1)
_CAPABILITY_SETS: Final = ("bounding", "effective", "permitted", "inheritable", "ambient")
# Docker's own defaults (moby: oci/defaults.go), and a small /tmp.
_NAMESPACES: Final = ("pid", "network", "ipc", "uts", "mount", "cgroup")
_MASKED: Final = [
    "/proc/asound", "/proc/acpi", "/proc/kcore", "/proc/keys", "/proc/latency_stats", "/proc/timer_list",
    "/proc/timer_stats", "/proc/sched_debug", "/proc/scsi", "/sys/firmware", "/sys/devices/virtual/powercap",
]  # fmt: skip
_READ_ONLY: Final = ["/proc/bus", "/proc/fs", "/proc/irq", "/proc/sys", "/proc/sysrq-trigger"]
_MOUNTS: Final = (
    ("/proc", "proc", "nosuid,noexec,nodev"),
    ("/dev", "tmpfs", "nosuid,strictatime,mode=755,size=65536k"),
    ("/dev/pts", "devpts", "nosuid,noexec,newinstance,ptmxmode=0666,mode=0620"),
    ("/dev/shm", "tmpfs", "nosuid,noexec,nodev,mode=1777,size=65536k"),  # noqa: S108  (a mount of its own)
    ("/dev/mqueue", "mqueue", "nosuid,noexec,nodev"),
    ("/sys", "sysfs", "nosuid,noexec,nodev,ro"),
    ("/tmp", "tmpfs", "nosuid,noexec,nodev,mode=1777,size=65536k"),  # noqa: S108  (likewise)
)
_CGROUP_MOUNT: Final = ("/sys/fs/cgroup", "cgroup", "nosuid,noexec,nodev,ro")

Done = subprocess.CompletedProcess[str]


@dataclass(frozen=True, slots=True)
class Runtime:
    """One image, unpacked, with one volume, and the way to start containers of it.

    Attributes:
        folder: holds ``rootfs``, ``data`` (the volume), and a bundle for each container.
        image: what is run.
        seccomp: the filter, as `tools.image.profile.resolve` made it.
    """

    folder: Path
    image: Image
    seccomp: Mapping[str, Any]

    def unpack(self) -> None:
        """Lay the image's files down, and a volume that belongs to its user; `folder` is empty before."""
        steps = (
            'mkdir "$1/rootfs" "$1/data" && tar -xpf "$2" --numeric-owner -C "$1/rootfs" '
            f'&& chown {UID}:{UID} "$1/data" && touch "$1/rootfs/.dockerenv"'
        )
        subprocess.run(
            _privileged("sh", "-c", steps, "sh", str(self.folder), str(self.image.archive)), check=True
        )

    def remove(self) -> None:
        """Delete everything that `unpack` and the containers made."""
        subprocess.run(_privileged("rm", "-r", str(self.folder)), check=True)

    @property
    def limited(self) -> bool:
        """Whether containers get limits of memory and processes."""
        return _is_root()

    def start(
        self,
        name: str,
        arguments: Sequence[str],
        *,
        environment: Mapping[str, str] | None = None,
        shown: Mapping[str, Path] | None = None,
    ) -> "subprocess.Popen[bytes]":
        """Start a container of that name as ``docker run`` does: the image's entry point with `arguments`.

        `printed` tells what it prints: a file, as Docker keeps one. It would stand still at a pipe that is full.
        """
        command = self._run(name, [*self.image.config["Entrypoint"], *arguments], environment, shown)
        with self._log(name).open("wb") as log:
            return subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT)

    def printed(self, name: str) -> str:
        """Return what the last container of that name that `start` started has printed so far."""
        return self._log(name).read_text(encoding="utf-8", errors="replace")

    def _log(self, name: str) -> Path:
        return self.folder / f"{name}.log"

    def run(self, *arguments: str, **more: Mapping[str, Any] | None) -> Done:
        """Run one container to its end: the image's entry point with `arguments`."""
        return self.run_program([*self.image.config["Entrypoint"], *arguments], **more)

    def run_program(
        self,
        command: Sequence[str],
        *,
        environment: Mapping[str, str] | None = None,
        shown: Mapping[str, Path] | None = None,
    ) -> Done:
        """Run `command` instead of the entry point, with `shown` files or folders at these places, read-only."""
        name = f"one-{next(_NUMBERS)}"
        return subprocess.run(
            self._run(name, command, environment, shown), capture_output=True, text=True, check=False
        )

    def execute(self, name: str, *command: str) -> Done:
        """Run a command in a container that is running, as ``docker exec`` does."""
        return subprocess.run(self._runc("exec", name, *command), capture_output=True, text=True, check=False)

    def signal(self, name: str, signal: str) -> None:
        """Send a signal to a container's process 1, as ``docker stop`` does first."""
        subprocess.run(self._runc("kill", name, signal), check=True)

    def _run(
        self,
        name: str,
        command: Sequence[str],
        environment: Mapping[str, str] | None,
        shown: Mapping[str, Path] | None,
    ) -> list[str]:
        bundle = self.folder / f"bundle-{next(_NUMBERS)}"
        bundle.mkdir()
        specification = self._specification(name)
        specification["process"]["args"] = list(command)
        specification["process"]["env"] += [f"{key}={value}" for key, value in (environment or {}).items()]
        specification["mounts"] += [
            _mount(target, "bind", "rbind,ro", str(path)) for target, path in (shown or {}).items()
        ]
        (bundle / "config.json").write_text(json.dumps(specification), encoding="utf-8")
        return self._runc("run", "--bundle", str(bundle), name)

    def _runc(self, *arguments: str) -> list[str]:
        return _privileged("runc", "--root", str(self.folder / "state"), *arguments)

    def _specification(self, name: str) -> dict[str, Any]:
        """Return a container's description in the words of the OCI runtime specification, less its program."""
        config = self.image.config
        uid, gid = map(int, config["User"].split(":"))
        volume = next(iter(config["Volumes"]))
        return {
            "ociVersion": "1.0.2",
            "hostname": "grader",
            "root": {"path": str(self.folder / "rootfs"), "readonly": True},
            "process": {
                "user": {"uid": uid, "gid": gid},
                "cwd": config["WorkingDir"],
                "env": list(config["Env"]),
                "noNewPrivileges": True,
                "capabilities": {kind: [] for kind in _CAPABILITY_SETS},
            },
            "mounts": [*_system_mounts(), _mount(volume, "bind", "rbind,rw", str(self.folder / "data"))],
            "linux": {
                "namespaces": [{"type": kind} for kind in _NAMESPACES],
                "seccomp": self.seccomp,
                "maskedPaths": _MASKED,
                "readonlyPaths": _READ_ONLY,
                **(_limits(name) if _is_root() else {}),
            },
        }


def _limits(name: str) -> dict[str, Any]:
    resources = {
        "devices": [{"allow": False, "access": "rwm"}],
        "memory": {"limit": MEMORY_BYTES},
        "pids": {"limit": TASKS},
    }
    return {"cgroupsPath": f"/grader-image-{os.getpid()}-{name}", "resources": resources}


def _system_mounts() -> list[dict[str, Any]]:
    return [_mount(*mount) for mount in (*_MOUNTS, *((_CGROUP_MOUNT,) if _is_root() else ()))]


def _mount(target: str, kind: str, options: str, source: str = "") -> dict[str, Any]:
    return {"destination": target, "type": kind, "source": source or kind, "options": options.split(",")}


def _is_root() -> bool:
    return os.geteuid() == 0


def _privileged(*command: str) -> list[str]:
    """Return `command` as who may set a container up: root, or root of a user namespace of one's own."""
    return list(command) if _is_root() else unprivileged.command(*command)
