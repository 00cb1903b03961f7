"""Tell what the sandbox can do on this host, by trying each part for real in a child.

`run_doctor` is all the command line needs: a `Diagnosis` with an exit code, plain data, and text.
"""

import os
import platform
import statistics
import time
from dataclasses import asdict, dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import Final

from grader.contracts.errors import SandboxError
from grader.contracts.limits import MIB, Limits
from grader.contracts.text import Language, Text
from grader.jail import landlock, libc
from grader.jail.box import SHIM_PATH, Proof, Sandbox
from grader.jail.cgroups import Bound, own_bound
from grader.jail.layers import REQUIRED, Layer, Mode
from grader.jail.remarks import (
    CANNOT_RUN,
    COST,
    LEAVES_OPEN,
    NO_OUTER_BOUND,
    OUTER_BOUND,
    READY,
    REDUCED,
    STATES,
    TITLES,
)

_TIMED_RUNS: Final = 40
_BARE: Final = frozenset(Layer) - {Layer.PROCESS, Layer.RLIMITS}


class State(StrEnum):
    """What came of trying one layer."""

    ACTIVE = "active"
    MISSING = "missing"  # required, and not to be had here
    ABSENT = "absent"  # optional, and not to be had here
    NOT_NEEDED = "not_needed"
    BROKEN = "broken"  # there, but something got through


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One layer, tried.

    Attributes:
        detail: what was seen, in neutral words (versions, ids, attempts that got through).
        leaves_open: what a script could do for lack of this layer; empty when it is active.
    """

    layer: Layer
    required: bool
    state: State
    detail: str
    leaves_open: Text


@dataclass(frozen=True, slots=True, kw_only=True)
class Diagnosis:
    """Everything `grader doctor` reports.

    Attributes:
        exit_code: 0 ready for strict mode, 1 reduced isolation only, 2 cannot run scripts at all.
        start_ms: median time to start, confine, end and reap one process; None when none could be started.
        bare_start_ms: the same without confinement.
        outer: the control groups' limits around the whole grader.
        error: why nothing could be run, or empty.
    """

    exit_code: int
    host: dict[str, str]
    findings: tuple[Finding, ...]
    start_ms: float | None
    bare_start_ms: float | None
    outer: Bound = field(default_factory=Bound)
    error: str = ""

    def to_dict(self) -> dict[str, object]:
        """Return plain JSON-ready data."""
        return asdict(self)

    def text(self, language: Language) -> str:
        """Return the diagnosis as a page of plain text."""
        marks = {State.ACTIVE: "✓", State.NOT_NEEDED: "–", State.ABSENT: "○"}
        lines = ["  ".join(f"{key}: {value}" for key, value in self.host.items()), ""]
        for finding in self.findings:
            state = STATES[finding.state].get(language)
            detail = f" ({finding.detail})" if finding.detail else ""
            title = TITLES[finding.layer].get(language)
            lines.append(f"{marks.get(finding.state, '✗')} {title}: {state}{detail}")
            if finding.leaves_open.en:
                lines.append(f"    {finding.leaves_open.get(language)}")
        lines.append(_outer_line(self.outer, language))
        if self.start_ms is not None and self.bare_start_ms is not None:
            lines += ["", COST.get(language).format(self.start_ms, self.bare_start_ms)]
        verdict = (READY, REDUCED, CANNOT_RUN)[self.exit_code].get(language)
        return "\n".join([*lines, "", f"{verdict} {self.error}".rstrip()])


def run_doctor(shim: Path = SHIM_PATH, entry: str = "rclpy._process.runner:run") -> Diagnosis:
    """Try every layer on this host. Takes about half a second; leaves nothing behind."""
    host = _describe_host()
    try:
        with Sandbox(Mode.BEST_EFFORT, shim, entry=entry) as sandbox:
            proof = sandbox.prove()
            missing = sandbox.missing_layers
            start_ms = _median_start_ms(sandbox)
        with Sandbox(Mode.BEST_EFFORT, shim, entry=entry, without=_BARE) as bare:
            bare_start_ms = _median_start_ms(bare)
    except SandboxError as error:
        return Diagnosis(
            exit_code=2,
            host=host,
            findings=(),
            start_ms=None,
            bare_start_ms=None,
            outer=own_bound(),
            error=str(error),
        )
    findings = tuple(_judge(layer, missing, proof) for layer in Layer)
    ready = not any(finding.state in (State.MISSING, State.BROKEN) for finding in findings)
    return Diagnosis(
        exit_code=0 if ready else 1,
        host=host,
        findings=findings,
        start_ms=start_ms,
        bare_start_ms=bare_start_ms,
        outer=own_bound(),
    )


def _outer_line(outer: Bound, language: Language) -> str:
    """Say what bounds the grader as a whole: what a script's limits do not count exactly adds up to that."""
    if outer.memory_bytes is None:
        return f"○ {NO_OUTER_BOUND.get(language)}"
    tasks = "–" if outer.tasks is None else str(outer.tasks)
    return f"✓ {OUTER_BOUND.get(language).format(outer.version, outer.memory_bytes // MIB, tasks)}"


def _judge(layer: Layer, missing: tuple[str, ...], proof: Proof) -> Finding:
    breaches = [breach for breach in proof.breaches if breach.startswith(f"{layer}: ")]
    required = layer in REQUIRED
    if layer is Layer.OWN_UID and os.geteuid() != 0:
        state = State.NOT_NEEDED
    elif layer in missing:
        state = State.MISSING if required else State.ABSENT
    else:
        state = State.BROKEN if breaches else State.ACTIVE
    detail = "; ".join(breach.partition(": ")[2] for breach in breaches)
    return Finding(
        layer=layer,
        required=required,
        state=state,
        detail=_seen(layer, proof) if state is State.ACTIVE else detail,
        leaves_open=Text(zh="", en="") if state in (State.ACTIVE, State.NOT_NEEDED) else LEAVES_OPEN[layer],
    )


def _seen(layer: Layer, proof: Proof) -> str:
    return {
        Layer.PROCESS: f"descriptors {', '.join(map(str, proof.descriptors))}",
        Layer.LANDLOCK: f"ABI {landlock.abi_version()}",
        Layer.OWN_UID: f"uid {proof.uid}",
    }.get(layer, "")


def _median_start_ms(sandbox: Sandbox) -> float:
    samples = []
    for _ in range(_TIMED_RUNS):
        started_ns = time.perf_counter_ns()
        with sandbox.open(Limits()):
            pass
        samples.append((time.perf_counter_ns() - started_ns) / 1e6)
    return round(statistics.median(samples), 2)


def _describe_host() -> dict[str, str]:
    in_container = any(os.path.exists(path) for path in ("/.dockerenv", "/run/.containerenv"))
    return {
        "system": f"{platform.system()} {platform.release()}",
        "machine": libc.MACHINE,
        "python": platform.python_version(),
        "user": str(os.geteuid()),
        "container": "yes" if in_container else "no",
    }
