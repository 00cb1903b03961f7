"""The sandbox: run one script under limits, confined, with a channel to the simulated world.

```python
with script_sandbox("strict") as sandbox:
    with sandbox.open(limits) as jail:        # forks and confines a process
        jail.send(start_frame)                # it now runs the script
        while (frame := jail.receive()) is not None:
            ...                               # None: it has ended, or a limit ended it
        report = jail.close()                 # how it ended, what it printed and used
```

There is one `Sandbox` per grading process and one `Jail` per run. The parts stand in `grader.jail`: what is
allowed in `syscalls` and `bounds`, the layers in `layers`, the process that all others are forked from in `zygote`
(its own side) and `supervisor` (this side), a run in `jail`, its end in `ending`.
"""

import json
import os
from collections.abc import Mapping, Set
from dataclasses import replace
from pathlib import Path
from typing import Final

from grader.contracts.assignment import Limits
from grader.contracts.errors import NoRoomError, SandboxError, SandboxUnavailableError, SettingsError
from grader.contracts.python import Self
from grader.contracts.record import Record
from grader.jail import bounds
from grader.jail.ending import JailReport, RunEnd
from grader.jail.jail import Jail
from grader.jail.layers import Layer, Mode, Program, choose, configure
from grader.jail.supervisor import Confined, Zygote

__all__ = [
    "PRELOADED",
    "RUN_SCRIPT",
    "SHIM_PATH",
    "Jail",
    "JailReport",
    "Layer",
    "Mode",
    "Proof",
    "RunEnd",
    "Sandbox",
    "pybullet_sandbox",
    "script_sandbox",
    "syntax_sandbox",
]

SHIM_PATH: Final = Path(__file__).parent / "shim"
PRELOADED: Final = ("rclpy._process.warm",)
"""What a zygote for scripts imports ahead: paid once per zygote instead of once per run."""
RUN_SCRIPT: Final = "rclpy._process.runner:run"
_CHECK_SYNTAX: Final = "rclpy._process.syntax:run"

_RUNS_PER_ZYGOTE: Final = 500
"""Forks after which a zygote is replaced, so that leaks in it cannot build up."""


def script_sandbox(mode: str) -> "Sandbox":
    """Start a sandbox whose processes run scripts.

    Raises:
        SettingsError: `mode` is not one of `Mode`.
        SandboxUnavailableError: this host lacks a layer that the mode requires.
        SandboxError: the zygote could not be started.
    """
    return Sandbox(_mode(mode), preload=PRELOADED)


def pybullet_sandbox(mode: str) -> "Sandbox":
    """Start a sandbox whose processes run scripts with PyBullet, or replay what these have called.

    Raises as `script_sandbox` does.
    """
    packages = {**bounds.ALLOWED_PACKAGES, **bounds.PYBULLET_PACKAGES}
    return Sandbox(_mode(mode), preload=(*PRELOADED, "rclpy._pybullet.warm"), packages=packages)


def syntax_sandbox(mode: str) -> "Sandbox":
    """Start a sandbox, confined like that of `script_sandbox`, whose processes compile a script and run nothing.

    Raises as `script_sandbox` does.
    """
    return Sandbox(_mode(mode), entry=_CHECK_SYNTAX)


def _mode(name: str) -> Mode:
    try:
        return Mode(name)
    except ValueError as error:
        raise SettingsError(f"isolation: {name!r} is not one of {', '.join(Mode)}") from error


class Proof(Record):
    """What a confined process saw when it tried to get out.

    Attributes:
        breaches: attempts that succeeded, as ``layer: what``; empty when all required layers hold.
        uid: user id inside.
        descriptors: open descriptors inside.
        environment: environment inside.
    """

    breaches: tuple[str, ...]
    uid: int
    descriptors: tuple[int, ...]
    environment: dict[str, str]


class Sandbox:
    """Owns one zygote, and forks one confined process per run from it.

    Not for use by several threads at once. Several jails may be open at a time.
    """

    def __init__(  # noqa: PLR0913
        self,
        mode: Mode = Mode.STRICT,
        shim_path: Path = SHIM_PATH,
        *,
        entry: str = RUN_SCRIPT,
        preload: tuple[str, ...] = (),
        packages: Mapping[str, tuple[str, ...]] = bounds.ALLOWED_PACKAGES,
        without: Set[Layer] = frozenset(),
    ) -> None:
        """Choose the layers and start the zygote, without waiting for it.

        Args:
            mode: what to do when a required layer is missing.
            shim_path: directory that is all of a script's own import path.
            entry: ``module:function`` that a confined process calls with the channel's descriptor.
            preload: modules to import before the first fork.
            packages: those of third parties that a script may import, with the directories each needs.
            without: layers to leave out.

        Raises:
            SandboxUnavailableError: STRICT, and this host lacks a required layer.
            SandboxError: the zygote could not be started.
        """
        self._mode = mode
        choice = choose(mode, without, shim_path)
        if mode is Mode.STRICT and choice.missing_required:
            names = ", ".join(choice.missing_required)
            raise SandboxUnavailableError(f"this host lacks a required layer of isolation: {names}")
        self._active = choice.active
        program = Program(shim=shim_path, entry=entry, preload=preload, packages=packages)
        self._config = configure(program, choice.active)
        self._runs = 0
        self._open_jails = 0
        self._spare: Confined | None = None
        self._proven = mode is not Mode.STRICT
        self._zygote = Zygote(self._config)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def mode(self) -> Mode:
        """How much isolation was asked for."""
        return self._mode

    @property
    def isolation(self) -> str:
        """Mode and active layers, such as ``strict: process+rlimits+seccomp+landlock``."""
        self._wait_ready()
        return f"{self._mode}: {'+'.join(self._active)}"

    @property
    def missing_layers(self) -> tuple[str, ...]:
        """Names of the layers that are not active, required or not."""
        self._wait_ready()
        return tuple(layer.value for layer in Layer if layer not in self._active)

    def warm_up(self) -> None:
        """Wait for the zygote and, in strict mode, for its proof, as the first `open` would have to.

        Raises as `open`.
        """
        if self._proven:
            return
        breaches = self.prove().breaches
        if breaches:
            raise SandboxUnavailableError(f"the sandbox does not hold: {'; '.join(breaches)}")
        self._proven = True

    def open(self, limits: Limits) -> Jail:
        """Fork and confine one process; it then waits for its first frame.

        Raises:
            SandboxUnavailableError: STRICT, and a required layer did not hold when tried.
            SandboxError: it could not be forked or confined. Nothing has run; the next call starts afresh.
        """
        spare, self._spare = self._spare, None
        if spare is not None:
            if spare.limits == limits and spare.waits():
                return self._begin(spare)
            spare.discard()
        return self._begin(self._confine(limits))

    def prepare(self, limits: Limits) -> None:
        """Fork and confine ahead the process that the next `open` with these limits returns. Harmless at any time.

        The process is in no other state than after `open`: it waits for its first frame, and its clocks start
        when it is opened. It is prepared only while no run is open and used up or ended by the next `open`,
        so that no run ever shares its user id with a process that waits.

        Raises SandboxError: as `open`.
        """
        if not self._open_jails and (self._spare is None or self._spare.limits != limits):
            self._drop_spare()
            self._spare = self._confine(limits)

    def prove(self) -> Proof:
        """Have a confined process try to get out, and return what it found. Takes a few milliseconds.

        Raises SandboxError: it could not be run, or did not report.
        """
        with self._begin(self._fork(Limits(cpu_s=5.0), prove=True)) as jail:
            body = jail.receive()
            report = jail.close()
        if body is None:
            raise SandboxError(f"the confined process did not report: {report.end} {report.detail}")
        answer = json.loads(body)
        breaches = list(answer["breaches"])
        expected = self._config.box_uid
        if expected is not None and answer["uid"] != expected:
            breaches.append(f"{Layer.OWN_UID}: run as user {answer['uid']}")
        if answer["descriptors"] != [0, 1, 2, 3]:
            breaches.append(f"{Layer.PROCESS}: inherit descriptors {answer['descriptors']}")
        return Proof(
            breaches=tuple(breaches),
            uid=answer["uid"],
            descriptors=tuple(answer["descriptors"]),
            environment=answer["environment"],
        )

    def restart(self) -> None:
        """Replace the zygote; runs in progress are ended."""
        self.close()
        self._zygote = Zygote(self._config)
        self._runs = 0

    def close(self) -> None:
        """End the zygote and everything it started."""
        self._drop_spare()
        self._zygote.close()

    def _drop_spare(self) -> None:
        spare, self._spare = self._spare, None
        if spare is not None:
            spare.discard()

    def _wait_ready(self) -> None:
        """Wait for the zygote; do without namespaces where the host lets us only begin."""
        if not self._zygote.alive:
            self.restart()
        try:
            self._zygote.wait_ready()
        except NoRoomError:  # says nothing about what the host offers
            self.restart()
            raise
        except SandboxError:
            if not self._config.namespaces:
                raise
            self._config = replace(self._config, namespaces=False)
            self.restart()
            self._zygote.wait_ready()
        if not self._zygote.namespaces:
            self._active = tuple(layer for layer in self._active if layer is not Layer.NAMESPACES)

    def _confine(self, limits: Limits) -> Confined:
        """Return a new process from a zygote that has proven itself and is not too old."""
        self.warm_up()
        if self._runs >= _RUNS_PER_ZYGOTE and not self._open_jails:
            self.restart()
        return self._fork(limits)

    def _fork(self, limits: Limits, *, prove: bool = False) -> Confined:
        try:
            self._wait_ready()
            confined = Confined(self._zygote, limits, count_threads=self._counts_threads, prove=prove)
        except SandboxError:
            self.restart()
            raise
        self._runs += 1
        return confined

    def _begin(self, confined: Confined) -> Jail:
        self._open_jails += 1
        return confined.begin(self._count_end)

    def _count_end(self) -> None:
        self._open_jails -= 1

    @property
    def _counts_threads(self) -> bool:
        """Whether the kernel can count one run's threads: only where no other process has its user id."""
        return Layer.OWN_UID in self._active or (Layer.NAMESPACES in self._active and os.geteuid() != 0)
