"""The sandbox's public face: run one script under limits, confined, with a channel to its episode.

with Sandbox() as sandbox:
    with sandbox.open(limits) as jail:
        jail.send(start_frame)
        while (frame := jail.receive()) is not None:
            ...
        report = jail.close()
"""

import os
import socket
import sys
from contextlib import ExitStack
from enum import StrEnum
from pathlib import Path
from types import TracebackType
from typing import Final, Self

from grader.contracts.errors import SandboxError, SandboxUnavailableError
from grader.contracts.limits import Limits
from grader.jail import landlock, layout, libc, policy
from grader.jail.jail import Jail, start_byte
from grader.jail.process import ProcessHandle
from grader.jail.report import JailReport, Verdict
from grader.jail.streams import Capture
from grader.jail.supervisor import FILTER_DIRECTORY, Zygote, ZygoteConfig

__all__ = ["Jail", "JailReport", "Mode", "Sandbox", "Verdict"]

_CONFINE_LIMIT_S: Final = 20.0
SHIM_PATH: Final = Path(__file__).with_name("shim")


class Mode(StrEnum):
    """How much isolation is asked for.

    STRICT refuses to run without the required layers. BEST_EFFORT runs with what the host offers and names
    what is missing. DEV leaves out the kernel's confinement: for one's own code on one's own computer.
    """

    STRICT = "strict"
    BEST_EFFORT = "best-effort"
    DEV = "dev"


class Sandbox:
    """Owns one zygote, and forks one confined process per run from it.

    Attributes:
        isolation: names of the active layers, joined by ``+``.
        missing_layers: names of required layers that are not active; empty in STRICT.
    """

    def __init__(  # noqa: PLR0913 - all but two are settings with one right value outside tests
        self,
        mode: Mode = Mode.STRICT,
        shim_path: Path = SHIM_PATH,
        *,
        preload_numpy: bool = False,
        namespaces: bool = False,
        entry: str = "rclpy._runner:run",
        preload: tuple[str, ...] = (),
    ) -> None:
        """Choose the layers and start the zygote, without waiting for it.

        Args:
            mode: what to do when a required layer is missing.
            shim_path: directory that is all of a script's own import path.
            preload_numpy: pay for numpy once instead of in each script that uses it.
            namespaces: also move the zygote to its own namespaces with a minimal root.
            entry: ``module:function`` that a confined process calls with the channel's descriptor.
            preload: modules to import before the first fork.

        Raises:
            SandboxUnavailableError: STRICT, and this host lacks a required layer.
            SandboxError: the zygote could not be started.
        """
        self._config = _configure(
            mode,
            shim_path,
            namespaces=namespaces,
            entry=entry,
            preload=(*preload, "numpy") if preload_numpy else preload,
        )
        self.missing_layers = _missing(self._config)
        if mode is Mode.STRICT and self.missing_layers:
            names = ", ".join(self.missing_layers)
            raise SandboxUnavailableError(f"this host lacks a required layer of isolation: {names}")
        self.isolation = _active(self._config)
        self._zygote = Zygote(self._config)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def open(self, limits: Limits) -> Jail:
        """Fork and confine one process; it then waits for its first frame.

        Raises:
            SandboxError: it could not be forked or confined. Nothing has run; the next call starts afresh.
        """
        try:
            return self._open(limits)
        except SandboxError:
            self.restart()
            raise

    def restart(self) -> None:
        """Replace the zygote; runs in progress are ended."""
        self._zygote.close()
        self._zygote = Zygote(self._config)

    def close(self) -> None:
        """End the zygote and everything it started."""
        self._zygote.close()

    def _open(self, limits: Limits) -> Jail:
        if not self._zygote.alive:
            self.restart()
        zygote = self._zygote
        zygote.wait_ready()
        threads = limits.threads if self._counts_threads else None
        with ExitStack() as undo:
            ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_STREAM)
            undo.callback(ours.close)
            with theirs:
                captures, writers = _pipes(undo)
                try:
                    pid, pidfd = zygote.fork(
                        (limits.cpu_s, limits.memory_bytes, threads), (theirs.fileno(), *writers)
                    )
                finally:
                    for writer in writers:
                        os.close(writer)
            process = ProcessHandle(pid, pidfd)
            undo.callback(process.close)
            start_byte(ours, _CONFINE_LIMIT_S)
            undo.pop_all()
        return Jail(ours, process, captures, limits, lambda: zygote.reap(pid))

    @property
    def _counts_threads(self) -> bool:
        return self._config.box_uid is not None or (self._config.namespaces and os.geteuid() != 0)


def _pipes(undo: ExitStack) -> tuple[tuple[Capture, Capture], tuple[int, int]]:
    """Return captures of two new pipes, to be closed by `undo`, and the pipes' writing ends."""
    stdout, stdout_writer = os.pipe()
    stderr, stderr_writer = os.pipe()
    captures = Capture(stdout), Capture(stderr)
    for capture in captures:
        undo.callback(capture.close)
    return captures, (stdout_writer, stderr_writer)


def _configure(
    mode: Mode, shim: Path, *, namespaces: bool, entry: str, preload: tuple[str, ...]
) -> ZygoteConfig:
    linux = sys.platform == "linux"
    confined = linux and mode is not Mode.DEV
    packages = layout.allowed_packages()
    readable = layout.readable_paths(shim, packages) if confined else []
    shown, masked = layout.mounted_paths(shim, packages) if namespaces else ([], [])
    own_uid = confined and os.geteuid() == 0
    return ZygoteConfig(
        shim=str(shim.resolve()),
        entry=entry,
        preload=preload,
        packages=packages,
        readable=readable,
        shown=[*shown, *policy.READABLE_DEVICES, *policy.WRITABLE_DEVICES],
        masked=masked,
        landlock=confined and landlock.abi_version() > 0,
        seccomp=confined and (FILTER_DIRECTORY / f"{libc.MACHINE}.bpf").exists(),
        namespaces=confined and namespaces,
        box_uid=_box_uid() if own_uid else None,
        keep_read=own_uid and not namespaces and not layout.reachable_by_others(readable),
    )


def _box_uid() -> int:
    """Return a user id that no one else on this host has: one per grading process."""
    with open("/proc/self/uid_map", encoding="ascii") as file:
        spans = [tuple(map(int, line.split())) for line in file]
    wanted = policy.BOX_UID_BASE + os.getpid()
    if any(first <= wanted < first + count for first, _, count in spans):
        return wanted
    return policy.BOX_UID_BASE_MAPPED + os.getpid() % policy.BOX_UID_COUNT_MAPPED


def _missing(config: ZygoteConfig) -> tuple[str, ...]:
    present = {"landlock": config.landlock, "seccomp": config.seccomp}
    return tuple(name for name, active in present.items() if not active)


def _active(config: ZygoteConfig) -> str:
    layers = {
        "rlimits": True,
        "seccomp": config.seccomp,
        "landlock": config.landlock,
        "own uid": config.box_uid is not None,
        "namespaces": config.namespaces,
    }
    return "+".join(name for name, active in layers.items() if active)
