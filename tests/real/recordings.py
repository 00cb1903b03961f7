"""Reads the recordings of this folder, strictly: `README.md` says what they are and how far two of them differ."""

import csv
import gzip
import io
import json
import math
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

FOLDER: Final = Path(__file__).parent
_ROOT: Final = FOLDER.parents[1]
_COLUMNS: Final = ["t", "x", "y", "theta", "linear_velocity", "angular_velocity"]
_FIELDS: Final[dict[str, type | tuple[type, ...]]] = {
    "id": str,
    "script": str,
    "args": list,
    "input": str,
    "horizon": (int, float),
    "duration": float,
    "exit_code": int,
    "interrupted": bool,
    "killed": bool,
    "lines": list,
    "middleware": str,
}
_SOMETIMES: Final[dict[str, type | tuple[type, ...]]] = {"updates": int, "interrupted_at": float}


@dataclass(frozen=True, slots=True, eq=False)
class Poses:
    """What a real subscriber of /turtle1/pose received; rest before and after is cut off.

    Attributes:
        t_s: since the script's process was started. The other columns are as in the message: `v_mps` is |v|.
    """

    t_s: NDArray[np.float64]
    x_m: NDArray[np.float64]
    y_m: NDArray[np.float64]
    theta_rad: NDArray[np.float64]
    v_mps: NDArray[np.float64]
    w_radps: NDArray[np.float64]


@dataclass(frozen=True)
class Recording:
    """One run of one script on the real thing.

    Attributes:
        id: its name; ID__again is a second run of the script of ID, ID__fastdds one with another middleware.
        script: the file that was run, as it was that day.
        stdin: what was typed.
        horizon_s: after which SIGINT was to come; `interrupted_at_s` says when it came, None if it did not.
        exit_code: negative: the signal that ended the process.
        lines: [seconds, out or err, text].
    """

    id: str
    script: Path
    args: tuple[str, ...]
    stdin: str
    horizon_s: float
    duration_s: float
    exit_code: int
    interrupted_at_s: float | None
    killed: bool
    lines: tuple[tuple[float, str, str], ...]
    middleware: str

    @property
    def of(self) -> str:
        """The recording's name without what tells it from others of the same script."""
        return self.id.removesuffix("__again").removesuffix("__fastdds")

    @cached_property
    def poses(self) -> Poses | None:
        """What turtlesim published; None where nobody listened."""
        return _poses(FOLDER / "runs" / f"{self.id}.csv.gz")


@cache
def ids() -> tuple[str, ...]:
    """Return the names of all recordings, sorted."""
    return tuple(sorted(path.stem for path in (FOLDER / "runs").glob("*.json")))


@cache
def recording(name: str) -> Recording:
    """Return one recording.

    Raises:
        ValueError: its file is not in the form that README.md describes.
    """
    said: dict[str, Any] = json.loads((FOLDER / "runs" / f"{name}.json").read_text("utf-8"))
    for field, kind in {
        **_FIELDS,
        **{field: kind for field, kind in _SOMETIMES.items() if field in said},
    }.items():
        if not isinstance(said.get(field), kind):
            raise ValueError(f"{name}: {field} is {said.get(field)!r}")
    if unknown := said.keys() - _FIELDS.keys() - _SOMETIMES.keys():
        raise ValueError(f"{name}: unknown {sorted(unknown)}")
    if said["id"] != name or said["interrupted"] != ("interrupted_at" in said):
        raise ValueError(f"{name}: contradicts itself")
    return Recording(
        id=name,
        script=_script(name, said["script"]),
        args=tuple(said["args"]),
        stdin=said["input"],
        horizon_s=float(said["horizon"]),
        duration_s=said["duration"],
        exit_code=said["exit_code"],
        interrupted_at_s=said.get("interrupted_at"),
        killed=said["killed"],
        lines=tuple(_line(name, line) for line in said["lines"]),
        middleware=said["middleware"],
    )


def _script(name: str, was: str) -> Path:
    """Return the copy of a script that was run: a solution's and a probe's stand here, others in the tree."""
    if was.startswith("<project>/assignments/"):
        path = FOLDER / "scripts" / f"sol__{Path(was).parent.name}.py"
    elif was.startswith("<project>/"):
        path = _ROOT / was.removeprefix("<project>/")
    else:
        path = FOLDER / "scripts" / Path(was).name
    if not path.is_file():
        raise ValueError(f"{name}: no script {path}")
    return path


def _line(name: str, line: object) -> tuple[float, str, str]:
    match line:
        case [int() | float() as t_s, "out" | "err" as stream, str(text)]:
            return float(t_s), stream, text
    raise ValueError(f"{name}: a line is {line!r}")


def _poses(path: Path) -> Poses | None:
    if not path.exists():
        return None
    header, *rows = csv.reader(io.StringIO(gzip.decompress(path.read_bytes()).decode("ascii")))
    if header != _COLUMNS or not rows:
        raise ValueError(f"{path.name}: columns {header}, {len(rows)} rows")
    table = np.array([[float(value) for value in row] for row in rows])
    if table.shape[1:] != (len(_COLUMNS),) or not (np.diff(table[:, 0]) > 0.0).all():
        raise ValueError(f"{path.name}: rows of unequal length, or times that do not increase")
    if not all(map(math.isfinite, table[:, 0])):
        raise ValueError(f"{path.name}: a time is not finite")
    return Poses(*table.T)
