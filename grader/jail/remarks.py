"""What the doctor says, in both languages."""

from typing import Final

from grader.contracts.text import Text
from grader.jail.layers import Layer

TITLES: Final = {
    Layer.PROCESS: Text(zh="独立进程、空环境", en="own process, empty environment"),
    Layer.RLIMITS: Text(zh="资源上限 (rlimits)", en="resource limits (rlimits)"),
    Layer.SECCOMP: Text(zh="系统调用白名单 (seccomp)", en="system call allowlist (seccomp)"),
    Layer.LANDLOCK: Text(zh="文件访问限制 (Landlock)", en="file confinement (Landlock)"),
    Layer.OWN_UID: Text(zh="独立用户号", en="own user id"),
    Layer.NAMESPACES: Text(zh="命名空间与最小根目录", en="namespaces and a minimal root"),
}

STATES: Final = {
    "active": Text(zh="已启用，并已实测", en="active, and tried"),
    "missing": Text(zh="缺失（必需）", en="missing (required)"),
    "absent": Text(zh="不可用（可选）", en="not available (optional)"),
    "not_needed": Text(zh="不需要（不是以 root 运行）", en="not needed (not run as root)"),
    "broken": Text(zh="未能拦住尝试", en="did not hold"),
}

LEAVES_OPEN: Final = {
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
}

READY: Final = Text(zh="可以用于严格模式 (strict)。", en="Ready for strict mode.")
REDUCED: Final = Text(
    zh="只能降级运行 (best-effort)：请勿运行陌生人的代码。",
    en="Reduced isolation only (best-effort): do not run strangers' code.",
)
CANNOT_RUN: Final = Text(zh="无法运行脚本：", en="No script can be run:")

COST: Final = Text(
    zh="启动一次受限进程 {:.1f} ms（不设限 {:.1f} ms）",
    en="one confined start takes {:.1f} ms ({:.1f} ms unconfined)",
)

OUTER_BOUND: Final = Text(
    zh="外层上限 (cgroup v{})：内存 {} MiB，进程与线程 {}",
    en="outer bound (cgroup v{}): {} MiB of memory, processes and threads: {}",
)
NO_OUTER_BOUND: Final = Text(
    zh="没有外层内存上限：请给容器 --memory，或给服务单元 MemoryMax=。",
    en="no outer memory bound: give the container --memory, or the service's unit MemoryMax=.",
)
