"""What a script prints and how it ends: on the real rclpy, as recorded, and here.

``python -m tests.real.output`` prints each difference that `differences.yaml` does not name, in the form that it
has there; with parts of names, only of these scripts.
"""

import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from difflib import SequenceMatcher
from functools import cache
from pathlib import Path
from typing import Any, Final

import yaml

from grader.contracts.assignment import Assignment, Case
from grader.contracts.grading import Grader, GradingJob
from grader.contracts.text import EMPTY
from grader.grading.outcome import masked
from tests.real.recordings import FOLDER, Recording, ids, recording
from tests.shim.conftest import run_script_text

DIFF: Final = FOLDER / "scripts" / "diff"
_NO_WORLD: Final[dict[str, Any]] = {"publishes": [], "subscribes": [], "services": [], "nodes": []}
_INSTALLED: Final = "/opt/ros/humble/local/lib/python3.10/dist-packages"
_FRAME: Final = re.compile(r'  File "([^"]*)", line \d+, in ')
_CARETS: Final = re.compile(r" +[~^]+")
_SHOWN: Final = 150
"""Characters of a line that the table quotes."""

_NORMALISED: Final = (
    # where the source of C stood when it was compiled: the packages of ROS name it from their own folder on
    (r"<ros>/(?:fast_)?src/\w+/\w+/", "./"),
    # where ROS was installed
    (r"<ros>/install/lib/python3.10/site-packages", _INSTALLED),
    (r"<ros>/build/\w+/rosidl_generator_py", _INSTALLED),
    # where the script stood
    (r"<ros>/tmp/run_\w+/|<dir>/diff/", ""),
    # when a log was written
    (r"\[\d{10}\.\d{9}\]", "[time]"),
    # where an object was
    (r"0x(?:[0-9a-f]{6,}|…)", "0x"),
    # random numbers
    (r"Goal ID: \[[ \d]+\]", "Goal ID: [random]"),
    (r"^GID: [0-9a-f.]+$", "GID: random"),
)
"""What differs from run to run, or from one installation to another, at home as well."""


@dataclass(frozen=True)
class Said:
    """What a run printed and how it ended.

    Attributes:
        exit_code: as a shell shows it; None: the recorder ended it.
    """

    out: tuple[str, ...]
    err: tuple[str, ...]
    exit_code: int | None


@dataclass(frozen=True)
class Difference:
    """Lines of one stream that are not the same; of ``exit`` the codes."""

    stream: str
    real: tuple[str, ...]
    ours: tuple[str, ...]


@cache
def scripts() -> tuple[str, ...]:
    """Return the names of everything that was recorded, each once: of recordings, and ``diff/`` of diff."""
    recorded = {recording(name).of for name in ids()}
    return (*sorted(recorded), *sorted(f"diff/{path.stem}" for path in DIFF.glob("*.py")))


@cache
def table() -> dict[str, Any]:
    """Return `differences.yaml`."""
    read: dict[str, Any] = yaml.safe_load((FOLDER / "differences.yaml").read_text("utf-8"))
    return read


def real(name: str) -> list[Said]:
    """Return what the real runs of a script said: that of the plain name first."""
    if name.startswith("diff/"):
        return [_real_diff(DIFF / f"{name[5:]}.real")]
    return [_said(recording(one)) for one in (name, f"{name}__again", f"{name}__fastdds") if one in ids()]


def ours(grader: Grader, name: str) -> Said:
    """Run a script here; return what it says."""
    if name.startswith("diff/"):
        path = DIFF / f"{name[5:]}.py"
        horizon_s = table()["ctrl_c_at_s"].get(name, 60.0)
        run = run_script_text(path.read_bytes(), horizon_s=horizon_s, world=_NO_WORLD, file_name=path.name)
        out, err = (masked(text, "humble") for text in (run.stdout, run.stderr))
        return Said(_lines(out, path.name), _lines(err, path.name), run.exit["code"])
    recorded = recording(name)
    assignment = Assignment(
        id="real",
        version=1,
        order=0,
        title=EMPTY,
        brief=EMPTY,
        check="node",
        items=(),
        horizon_s=table()["ctrl_c_at_s"].get(name, recorded.horizon_s),
        cases=(Case(stdin=recorded.stdin, args=recorded.args),),
    )
    script = recorded.script
    job = GradingJob(file_name=script.name, source=script.read_bytes(), assignment=assignment)
    outcome = grader.grade(job).report.runs[0].outcome
    assert not outcome.stdout.dropped_bytes
    assert not outcome.stderr.dropped_bytes
    return Said(
        _lines(outcome.stdout.text, script.name), _lines(outcome.stderr.text, script.name), outcome.exit_code
    )


def differences(name: str, here: Said) -> list[Difference]:
    """Return where ours is unlike every real run, in what no two real runs differ."""
    recorded = real(name)
    found = []
    if here.exit_code not in (codes := [one.exit_code for one in recorded]) and None not in codes:
        found.append(Difference("exit", (str(recorded[0].exit_code),), (str(here.exit_code),)))
    for stream in ("out", "err"):
        first, *others = [_cleared(name, getattr(one, stream)) for one in recorded]
        mine = _cleared(name, getattr(here, stream))
        if mine == first or mine in others:
            continue
        varies, variants = _variation(first, others)
        for lines, real_lines, our_lines in _hunks(first, mine):
            if lines and lines <= varies and len(real_lines) == len(our_lines):
                continue
            if (lines, real_lines, our_lines) not in variants:
                found.append(Difference(stream, real_lines, our_lines))
    return found


def reason(name: str, difference: Difference) -> str | None:
    """Return the key of the reason that the table gives for a difference."""
    rows = table()["differences"].get(name, ())
    return next((str(row["why"]) for row in rows if _names(row, difference)), None)


def stale(name: str, found: list[Difference]) -> list[dict[str, Any]]:
    """Return the table's rows of a script that no difference needs."""
    rows = table()["differences"].get(name, ())
    return [row for row in rows if not any(_names(row, one) for one in found)]


def _names(row: dict[str, Any], difference: Difference) -> bool:
    if row["in"] != difference.stream:
        return False
    if "every_line" in row:
        return all(re.search(row["every_line"], line) for line in difference.real + difference.ours)
    return all(_abbreviated(getattr(difference, side)) == row.get(side, []) for side in ("real", "ours"))


def _real_diff(path: Path) -> Said:
    text = path.read_text("utf-8").rstrip("\n")
    match = re.fullmatch(r"(.*)\n--ERR\n(.*?)(?:sigint )?(?:exit (-?\d+)|killed)", text, re.DOTALL)
    assert match, path
    out, err, code = match.groups()
    script = path.with_suffix(".py").name
    return Said(_lines(out, script), _lines(err.strip("\n"), script), code and _shell_code(int(code)))


def _said(recorded: Recording) -> Said:
    streams = [
        _lines("".join(text for _, where, text in recorded.lines if where == stream), recorded.script.name)
        for stream in ("out", "err")
    ]
    return Said(*streams, None if recorded.killed else _shell_code(recorded.exit_code))


def _shell_code(code: int) -> int:
    return 128 - code if code < 0 else code


def _lines(text: str, script: str) -> tuple[str, ...]:
    """Return normalised lines, without the frames of other files, which tracebacks here leave out."""
    for pattern, replacement in _NORMALISED:
        text = re.sub(pattern, replacement, text, flags=re.MULTILINE)
    kept, foreign = [], False
    for line in text.rstrip("\n").split("\n") if text else ():
        if frame := _FRAME.match(line):
            foreign = Path(frame[1]).name != script
        elif not (foreign and line.startswith("    ")):
            foreign = False
        if not foreign and not _CARETS.fullmatch(line):  # Python 3.10 has no carets
            kept.append(line)
    return tuple(kept)


def _cleared(name: str, lines: tuple[str, ...]) -> tuple[str, ...]:
    """Replace what the table says a script prints of its clock."""
    pattern = table()["clocks"].get(name)
    return tuple(re.sub(pattern, "clock", line) for line in lines) if pattern else lines


def _hunks(
    before: tuple[str, ...], after: tuple[str, ...]
) -> Iterator[tuple[frozenset[int], tuple[str, ...], tuple[str, ...]]]:
    for tag, i, j, k, m in SequenceMatcher(a=before, b=after, autojunk=False).get_opcodes():
        if tag != "equal":
            yield frozenset(range(i, j)), before[i:j], after[k:m]


def _variation(first: tuple[str, ...], others: list[tuple[str, ...]]) -> tuple[frozenset[int], list[Any]]:
    """Return which lines of a real run others have otherwise, and how."""
    variants = [hunk for other in others for hunk in _hunks(first, other)]
    return frozenset(line for lines, _, _ in variants for line in lines), variants


def _abbreviated(lines: tuple[str, ...]) -> list[str]:
    return [line if len(line) <= _SHOWN else line[:_SHOWN] + "…" for line in lines]


def main(*parts: str) -> int:
    """Print what the table lacks, and what it has too much; return 0 when that is nothing."""
    from grader.grading.slot import Slot, SlotConfig

    missing: dict[str, list[dict[str, Any]]] = {}
    counts: dict[str, int] = {}
    with Slot(SlotConfig()) as slot:
        for name in scripts():
            if parts and not any(part in name for part in parts):
                continue
            found = differences(name, ours(slot, name))
            reasons = {reason(name, one) for one in found}
            counts[_kind(reasons)] = counts.get(_kind(reasons), 0) + 1
            for row in stale(name, found):
                print(f"stale: {name}: {row}")
            for one in found:
                if reason(name, one) is None:
                    row = {"in": one.stream, "real": _abbreviated(one.real), "ours": _abbreviated(one.ours)}
                    missing.setdefault(name, []).append({k: v for k, v in row.items() if v} | {"why": ""})
    if missing:
        print(yaml.safe_dump(missing, allow_unicode=True, width=250, sort_keys=False))
    print(counts)
    return int(bool(missing))


def _kind(reasons: set[str | None]) -> str:
    return "unexplained" if None in reasons else "named" if reasons else "equal"


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
