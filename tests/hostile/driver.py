"""Run hostile scripts in one sandbox and report, as JSON lines, what happened and what was left behind.

Run as a program, so that the same steps can be taken as another user and behind another host's filter:
``driver.py OPTIONS`` with OPTIONS a JSON object: ``uid`` (to become first, or null), ``filter`` (path of a
seccomp filter to put on first, or null), ``without`` (layers), ``root`` (where to prepare what takes Landlock's
place, or null), ``scripts`` (paths). Standard library only.
"""

import gc
import json
import os
import re
import sys
import time
from collections import deque
from dataclasses import replace
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1]))

from grader.contracts.assignment import MIB, Limits  # noqa: E402
from grader.jail import bounds, layers, libc, prepared_root, syscalls  # noqa: E402
from grader.jail.ending import JailReport  # noqa: E402
from grader.sandbox import Layer, Sandbox  # noqa: E402

LIMITS = Limits(cpu_s=5.0, memory_bytes=128 * MIB, output_bytes=1 * MIB, threads=24)
SHORT = replace(LIMITS, cpu_s=0.06)  # ten times what a script takes up to its attack
BRIEF = replace(LIMITS, wall_s=0.5)
WATCHED = ("/tmp", "/var/tmp", "/dev/shm", "/run/lock", "/dev/mqueue", str(HERE), str(HERE / "runner"))
GOOD = (
    b"import fcntl\nprint(object(), sorted({'a', 'b'}), {'x', 'y', 'z'})\n"
    b"print(fcntl.fcntl(0, fcntl.F_GETFL))\nframe(b'pose')\n"
)


def become(uid: int | None, filter_path: str | None) -> None:
    """Turn into an ordinary user, and put on the filter of a container engine."""
    if uid is not None:
        os.setgroups([])
        os.setresgid(uid, uid, uid)
        os.setresuid(uid, uid, uid)
    if filter_path is not None:
        libc.prctl(libc.PR_SET_NO_NEW_PRIVS, 1)
        syscalls.load(Path(filter_path).read_bytes())


def run(sandbox: Sandbox, source: bytes, limits: Limits = LIMITS) -> tuple[list[str], JailReport]:
    """Run `source`; return the frames it sent and the account."""
    frames: deque[str] = deque(maxlen=5)
    with sandbox.open(limits) as jail:
        jail.send(source)
        while (frame := jail.receive()) is not None:
            frames.append(frame[:60].hex())
        return list(frames), jail.close()


def traces(sandbox: Sandbox) -> dict[str, object]:
    """Return everything of this host that a script must leave as it was."""
    gc.collect()
    zygote = sandbox._zygote._process.pid
    return {
        "descriptors": len(os.listdir("/proc/self/fd")),
        "files": {path: sorted(names(path)) for path in WATCHED if os.path.isdir(path)},
        "ipc": {
            **{kind: Path(f"/proc/sysvipc/{kind}").read_text() for kind in ("sem", "msg")},
            "shm": segments(),
        },
        "processes": descendants(zygote),
        "zygote": zygote,
    }


def segments() -> list[str]:
    """Shared memory whose maker is gone: a database server that runs meanwhile has some of its own."""
    creator = 4
    rows = Path("/proc/sysvipc/shm").read_text().splitlines()[1:]
    return [row for row in rows if not os.path.exists(f"/proc/{row.split()[creator]}")]


def names(path: str) -> list[str]:
    """Entries of `path` that another program running meanwhile would not make."""
    own = re.compile("evil")
    return [name for name in os.listdir(path) if own.search(name)]


def descendants(pid: int) -> int:
    """Count live or dead processes below `pid`."""
    total = 0
    for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split():
        total += 1 + descendants(int(child))
    return total


def main() -> None:
    options = json.loads(sys.argv[1])
    become(options["uid"], options["filter"])
    # the same rules, with less patience
    bounds.IDLE_LIMIT_NS = 150_000_000  # type: ignore[misc]
    bounds.FRAMES_MAX = 40_000  # type: ignore[misc]
    os.environ["SECRET_TOKEN"] = "canary-in-the-environment"
    without = frozenset(map(Layer, options["without"]))
    if options["root"] is not None:
        prepared_root.PLACE = Path(options["root"])  # type: ignore[misc]
        layers.prepare_root(HERE / "runner")
    sandbox = Sandbox(shim_path=HERE / "runner", entry="bare_runner:run", without=without)
    with sandbox:
        baseline, first = run(sandbox, GOOD)
        print(json.dumps({"isolation": sandbox.isolation, "good": [baseline, first.stdout.text, first.end]}))
        gc.freeze()  # `traces` looks for garbage after each script: not among all that was imported
        before = traces(sandbox)
        for script in options["scripts"]:
            source = Path(script).read_bytes()
            started = time.monotonic()
            limits = SHORT if b"Expected: cpu_limit" in source else LIMITS
            frames, report = run(sandbox, source, BRIEF if b"only the wall clock" in source else limits)
            wall_s = time.monotonic() - started
            after = traces(sandbox)
            good_frames, good = run(sandbox, GOOD)
            result = {
                "script": script,
                "end": report.end,
                "detail": report.detail,
                "signal": report.signal,
                "exit_code": report.exit_code,
                "stdout": report.stdout.text[-20_000:],
                "stderr": report.stderr.text[-4_000:],
                "output_bytes": len(report.stdout.text) + len(report.stderr.text),
                "peak_bytes": report.peak_bytes,
                "frames": frames,
                "wall_s": wall_s,
                "left_behind": {
                    key: [before[key], after[key]] for key in before if before[key] != after[key]
                },
                "good_again": [good_frames, good.stdout.text, good.end],
            }
            print(json.dumps(result), flush=True)


if __name__ == "__main__":
    main()
