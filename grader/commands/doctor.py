"""`grader doctor`: try every layer of the sandbox for real and say in words what is missing."""

import argparse
import json
import os
import platform
import statistics
import sys
import time
from contextlib import closing
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Final

from grader.commands.options import add_language_option
from grader.contracts.assignment import MIB, Limits
from grader.contracts.errors import InfrastructureError, SandboxError, SandboxUnavailableError
from grader.contracts.python import StrEnum
from grader.contracts.text import EMPTY, Language, Text
from grader.jail import landlock, libc
from grader.jail.cgroups import Bound, own_bound
from grader.jail.layers import REQUIRED, Layer, Mode, prepare_root
from grader.jail.prepared_root import PLACE
from grader.sandbox import RUN_SCRIPT, SHIM_PATH, Proof, Sandbox

_TIMED_RUNS: Final = 40
_BARE: Final = frozenset(Layer) - {Layer.PROCESS, Layer.RLIMITS}
_TITLES: Final = {
    Layer.PROCESS: Text(zh="独立进程、空环境", en="own process, empty environment"),
    Layer.RLIMITS: Text(zh="资源上限 (rlimits)", en="resource limits (rlimits)"),
    Layer.SECCOMP: Text(zh="系统调用白名单 (seccomp)", en="system call allowlist (seccomp)"),
    Layer.LANDLOCK: Text(zh="文件访问限制 (Landlock)", en="file confinement (Landlock)"),
    Layer.OWN_UID: Text(zh="独立用户号", en="own user id"),
    Layer.NAMESPACES: Text(zh="命名空间与最小根目录", en="namespaces and a minimal root"),
    Layer.OWN_ROOT: Text(zh="预备的根目录", en="a prepared root directory"),
}
_STATES: Final = {
    "active": Text(zh="已启用，并已实测", en="active, and tried"),
    "missing": Text(zh="缺失（必需）", en="missing (required)"),
    "absent": Text(zh="不可用（可选）", en="not available (optional)"),
    "not_needed": Text(zh="不需要（不是以 root 运行）", en="not needed (not run as root)"),
    "broken": Text(zh="未能拦住尝试", en="did not hold"),
}
_LEAVES_OPEN: Final = {
    Layer.PROCESS: Text(
        zh="脚本可能看到评分程序的环境变量或打开的文件。",
        en="A script may see the grader's environment or open files.",
    ),
    Layer.RLIMITS: Text(
        zh="脚本可能耗尽内存或处理器时间。", en="A script may use up memory or processor time."
    ),
    Layer.SECCOMP: Text(
        zh="脚本可以启动进程、联网、向其他进程发信号，或使用内核的冷门接口。"
        "需要 x86_64 或 aarch64，内核启用 CONFIG_SECCOMP_FILTER。",
        en="A script can start processes, use the network, signal other processes or reach rare kernel "
        "interfaces. The kernel needs CONFIG_SECCOMP_FILTER, on x86_64 or aarch64.",
    ),
    Layer.LANDLOCK: Text(
        zh="脚本可以读写评分用户能读写的一切文件，包括参考答案。需要 Linux 5.13 以上并启用 Landlock，"
        "容器引擎也须较新。",
        en="A script can read and write every file that the grader's user can, reference solutions "
        "included. Linux 5.13 or later with Landlock enabled is needed, and a recent container engine.",
    ),
    Layer.OWN_UID: Text(
        zh="脚本会以 root 身份运行。请用普通用户运行评分程序，或给容器 SETUID 和 SETGID 权能。",
        en="A script would run as root. Run the grader as an ordinary user, or give the container the "
        "capabilities SETUID and SETGID.",
    ),
    Layer.NAMESPACES: Text(
        zh="脚本能探知某些文件是否存在；其余由其他层拦截。普通容器里一向如此。",
        en="A script can find out whether a file exists; the other layers stop the rest. In ordinary "
        "containers this is normal.",
    ),
    Layer.OWN_ROOT: Text(
        zh="可以代替 Landlock：在以 root 运行、允许 chroot 的容器里运行 grader doctor --prepare-root。",
        en="It can take Landlock's place: run grader doctor --prepare-root in a container that runs as root and "
        "may chroot.",
    ),
}
_READY: Final = Text(zh="可以用于严格模式 (strict)。", en="Ready for strict mode.")
_REDUCED: Final = Text(
    zh="只能降级运行 (best-effort)：请勿运行陌生人的代码。",
    en="Reduced isolation only (best-effort): do not run strangers' code.",
)
_CANNOT_RUN: Final = Text(zh="无法运行脚本：", en="No script can be run:")
_COST: Final = Text(
    zh="启动一次受限进程 {:.1f} ms（不设限 {:.1f} ms）",
    en="one confined start takes {:.1f} ms ({:.1f} ms unconfined)",
)
_OUTER_BOUND: Final = Text(
    zh="外层上限 (cgroup v{})：内存 {} MiB，进程与线程 {}",
    en="outer bound (cgroup v{}): {} MiB of memory, processes and threads: {}",
)
_CONNECTIONS: Final = Text(
    zh="数据库服务器最多允许 {most} 个连接，现有 {taken} 个。",
    en="the database server takes {most} connections and has {taken}",
)
_NO_OUTER_BOUND: Final = Text(
    zh="没有外层内存上限：请给容器 --memory，或给服务单元 MemoryMax=。",
    en="no outer memory bound: give the container --memory, or the service's unit MemoryMax=.",
)


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument("--json", action="store_true", help="print the findings as JSON / 以 JSON 输出")
    parser.add_argument(
        "--prepare-root",
        action="store_true",
        help="make what takes Landlock's place in a container that is root's / 为没有 Landlock 的容器准备根目录",
    )
    add_language_option(parser)


def run(arguments: argparse.Namespace) -> int:
    """Diagnose; 0 ready for strict mode, 1 reduced isolation only, 2 cannot run scripts."""
    if arguments.prepare_root:
        _prepare_root()
    diagnosis, connections = run_doctor(), _server_connections()
    if arguments.json:
        more = {} if connections is None else {"database_connections": connections}
        document = diagnosis.to_dict() | more
        sys.stdout.write(json.dumps(document, ensure_ascii=False, indent=2) + "\n")
    else:
        sys.stdout.write(diagnosis.text(arguments.lang) + "\n")
        if connections is not None:
            sys.stdout.write(_CONNECTIONS.get(arguments.lang).format(**connections) + "\n")
    return diagnosis.exit_code


def _server_connections() -> dict[str, int] | None:
    """Return how many connections the settings' PostgreSQL server takes and has; None: there is no server."""
    if not any("DATABASE_URL" in name for name in os.environ):
        return None  # an installation that only checks files cannot even read settings
    from grader.operation.settings import load
    from grader.store.database import Database
    from grader.store.occupancy import room

    with closing(Database(load().database_url)) as database:
        try:
            there = room(database)
        except InfrastructureError as error:
            sys.stderr.write(f"{error}\n")
            return None
    return None if there is None else there._asdict()


def _prepare_root() -> None:
    try:
        prepare_root(SHIM_PATH)
    except OSError as error:
        raise SandboxUnavailableError(
            f"the root directory {PLACE} could not be made: {error}. It takes root and the right to make devices.",
            f"无法准备根目录 {PLACE}：{error}。需要 root 和创建设备文件的权限。",
        ) from error


# ---------------------------------------------------------------------------------------------- findings


class State(StrEnum):
    """How trying one layer went."""

    ACTIVE = "active"
    MISSING = "missing"  # required, but not available here
    ABSENT = "absent"  # optional, and not available here
    NOT_NEEDED = "not_needed"
    BROKEN = "broken"  # there, but something got through


@dataclass(frozen=True, slots=True, kw_only=True)
class LayerFinding:
    """One layer, tried.

    Attributes:
        detail: what was seen (versions, ids, attempts that got through), in no language.
        leaves_open: what a script could do without this layer; empty when it is active.
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
    findings: tuple[LayerFinding, ...]
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
            state = _STATES[finding.state].get(language)
            detail = f" ({finding.detail})" if finding.detail else ""
            title = _TITLES[finding.layer].get(language)
            lines.append(f"{marks.get(finding.state, '✗')} {title}: {state}{detail}")
            if finding.leaves_open.en:
                lines.append(f"    {finding.leaves_open.get(language)}")
        lines.append(_outer_line(self.outer, language))
        if self.start_ms is not None and self.bare_start_ms is not None:
            lines += ["", _COST.get(language).format(self.start_ms, self.bare_start_ms)]
        summary = (_READY, _REDUCED, _CANNOT_RUN)[self.exit_code].get(language)
        return "\n".join([*lines, "", f"{summary} {self.error}".rstrip()])


def run_doctor(shim: Path = SHIM_PATH, entry: str = RUN_SCRIPT) -> Diagnosis:
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
    findings = tuple(_finding(layer, missing, proof) for layer in _shown_layers(missing))
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
    """Say what bounds the whole grader: it also catches what a script's own limits count inexactly."""
    if outer.memory_bytes is None:
        return f"○ {_NO_OUTER_BOUND.get(language)}"
    tasks = "–" if outer.tasks is None else str(outer.tasks)
    return f"✓ {_OUTER_BOUND.get(language).format(outer.version, outer.memory_bytes // MIB, tasks)}"


def _shown_layers(missing: tuple[str, ...]) -> list[Layer]:
    """Return the layers to report; the one that replaces Landlock only where Landlock is missing."""
    return [layer for layer in Layer if layer is not Layer.OWN_ROOT or Layer.LANDLOCK in missing]


def _finding(layer: Layer, missing: tuple[str, ...], proof: Proof) -> LayerFinding:
    breaches = [breach for breach in proof.breaches if breach.startswith(f"{layer}: ")]
    replaced = layer is Layer.LANDLOCK and Layer.OWN_ROOT not in missing
    required = layer in REQUIRED and not replaced
    if layer is Layer.OWN_UID and os.geteuid() != 0:
        state = State.NOT_NEEDED
    elif layer in missing:
        state = State.MISSING if required else State.ABSENT
    else:
        state = State.BROKEN if breaches else State.ACTIVE
    detail = "; ".join(breach.partition(": ")[2] for breach in breaches)
    return LayerFinding(
        layer=layer,
        required=required,
        state=state,
        detail=_seen(layer, proof) if state is State.ACTIVE else detail,
        leaves_open=EMPTY if replaced or state in (State.ACTIVE, State.NOT_NEEDED) else _LEAVES_OPEN[layer],
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
