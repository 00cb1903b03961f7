"""Motions without a simulator: turns legs into trajectories and runs, exactly or with lag, noise and wobble.

The car obeys at once: each velocity holds until the next command, and arcs are integrated in closed form.
"""

import itertools
import math
from collections.abc import Iterable, Sequence

import numpy as np

from grader.contracts.outcome import Endpoint, RunOutcome, RunStatus, StudentError
from grader.contracts.scoring import Run
from grader.contracts.trajectory import Command, Trajectory

Leg = tuple[float, float, float]  # duration in s, v in m/s, w in rad/s
PERIOD_S = 1.0 / 60.0
START = (5.544445, 5.544445)


def polygon_legs(
    sides: int,
    side_m: float = 2.0,
    *,
    v_mps: float = 1.0,
    w_radps: float = 1.0,
    corners_deg: Sequence[float] | None = None,
    lengths_m: Sequence[float] | None = None,
    pause_s: float = 0.1,
    laps: float = 1,
    last_turn: bool = True,
) -> list[Leg]:
    """Drive, pause, turn, pause for each side; negative `w_radps` turns right."""
    count = round(sides * laps)
    corners = list(corners_deg or [360.0 / sides] * count)
    lengths = list(lengths_m or [side_m] * count)
    legs: list[Leg] = []
    for i in range(count):
        legs += [(lengths[i] / abs(v_mps), v_mps, 0.0), (pause_s, 0.0, 0.0)]
        if i < count - 1 or last_turn:
            turn = math.radians(corners[i])
            legs += [(abs(turn / w_radps), 0.0, math.copysign(w_radps, turn * w_radps)), (pause_s, 0.0, 0.0)]
    return legs


def drive(
    legs: Iterable[Leg],
    *,
    heading_deg: float = 0.0,
    start_m: tuple[float, float] = START,
    period_s: float = PERIOD_S,
    horizon_s: float | None = None,
    idle_s: float = 1.0,
    noise_m: float = 0.0,
    noise_rad: float = 0.0,
    lag_s: float = 0.0,
    seed: int = 1,
) -> Trajectory:
    """Integrate `legs` and sample the motion every `period_s`; `lag_s` smooths velocities exponentially."""
    legs = [leg for leg in legs if leg[0] > 0.0]
    edges = np.concatenate(([0.0], np.cumsum([duration for duration, _, _ in legs])))
    total_s = float(edges[-1]) + idle_s
    end_s = total_s if horizon_s is None else horizon_s
    fine_s = min(period_s, end_s) / 4.0 if lag_s else period_s
    times = np.unique(np.concatenate((np.arange(0.0, end_s, fine_s), edges[edges < end_s], [end_s])))
    middle = (times[1:] + times[:-1]) / 2.0
    index = np.searchsorted(edges, middle, side="right") - 1
    v = np.array([leg[1] for leg in legs] + [0.0])[np.minimum(index, len(legs))]
    w = np.array([leg[2] for leg in legs] + [0.0])[np.minimum(index, len(legs))]
    steps = np.diff(times)
    if lag_s:
        v, w = _lagged(v, steps, lag_s), _lagged(w, steps, lag_s)
    heading = np.concatenate(([0.0], np.cumsum(w * steps))) + math.radians(heading_deg)
    half = w * steps / 2.0
    chord = v * steps * np.sinc(half / math.pi)
    x = np.concatenate(([0.0], np.cumsum(chord * np.cos(heading[:-1] + half)))) + start_m[0]
    y = np.concatenate(([0.0], np.cumsum(chord * np.sin(heading[:-1] + half)))) + start_m[1]
    speeds = (np.concatenate(([0.0], v)), np.concatenate(([0.0], w)))
    # A recorder samples at its own instants: a corner may fall between two samples.
    kept = np.unique(np.append(np.searchsorted(times, np.arange(0.0, end_s, period_s)), len(times) - 1))
    rng = np.random.default_rng(seed)
    noise = rng.standard_normal((3, len(kept)))
    return Trajectory(
        t_ns=np.round(times[kept] * 1e9).astype(np.int64),
        x_m=x[kept] + noise_m * noise[0],
        y_m=y[kept] + noise_m * noise[1],
        heading_rad=heading[kept] + noise_rad * noise[2],
        v_mps=speeds[0][kept],
        w_radps=speeds[1][kept],
        end_ns=round(end_s * 1e9),
        commands=_commands(legs, edges, end_s),
    )


def once_each(legs: list[tuple[float, float, float]]) -> Trajectory:
    """Each velocity published once; the car stops a second later."""
    seen: list[tuple[float, float, float]] = []
    commands, now_s = [], 0.0
    for duration, v, w in legs:
        commands.append(Command(t_ns=round(now_s * 1e9), v_mps=v, w_radps=w))
        seen += [(min(duration, 1.0), v, w), (max(duration - 1.0, 0.0), 0.0, 0.0)]
        now_s += duration
    commands.append(Command(t_ns=round(now_s * 1e9), v_mps=0.0, w_radps=0.0))
    trajectory = drive(seen)
    values = {name: getattr(trajectory, name) for name in Trajectory.__slots__}
    return Trajectory(**{**values, "commands": tuple(commands)})


def _lagged(values: np.ndarray, steps: np.ndarray, lag_s: float) -> np.ndarray:
    out, state = np.empty_like(values), 0.0
    edges = [0, *(np.flatnonzero(np.diff(values)) + 1), len(values)]
    for first, last in itertools.pairwise(edges):  # the command is constant between two edges
        decay = np.exp(-np.cumsum(steps[first:last]) / lag_s)
        out[first:last] = values[first] + (state - values[first]) * decay
        state = out[last - 1]
    return out


def _commands(legs: list[Leg], edges: np.ndarray, end_s: float) -> tuple[Command, ...]:
    """Publish each velocity every 0.1 s, as a timer would, and a stop at the end."""
    commands = []
    for start, (duration, v, w) in zip(edges, legs, strict=False):
        for t in np.arange(start, start + duration, 0.1):
            if t < end_s:
                commands.append(Command(t_ns=round(t * 1e9), v_mps=v, w_radps=w))
    if float(edges[-1]) < end_s:
        commands.append(Command(t_ns=round(float(edges[-1]) * 1e9), v_mps=0.0, w_radps=0.0))
    return tuple(commands)


def outcome_of(
    trajectory: Trajectory, status: RunStatus = RunStatus.FINISHED, **changes: object
) -> RunOutcome:
    """The outcome of a script that sent the trajectory's commands from one well-behaved node."""
    commands = trajectory.commands
    values: dict[str, object] = {
        "status": status,
        "duration_ns": trajectory.end_ns,
        "nodes": ("/mover",),
        "endpoints": (
            Endpoint(
                kind="publisher",
                node="/mover",
                name="/turtle1/cmd_vel",
                type="geometry_msgs/msg/Twist",
                count=len(commands),
            ),
        ),
        "command_count": len(commands),
        "first_command_ns": commands[0].t_ns if commands else None,
        "last_command_ns": commands[-1].t_ns if commands else None,
    }
    return RunOutcome(**{**values, **changes})  # type: ignore[arg-type]


def run_of(trajectory: Trajectory, status: RunStatus = RunStatus.FINISHED, **changes: object) -> Run:
    return Run(trajectory=trajectory, outcome=outcome_of(trajectory, status, **changes))


def error(kind: str, message: str, *lines: str) -> StudentError:
    """Return an exception whose traceback shows `lines`, each in a frame of its own."""
    frames = "".join(f'  File "a.py", line 17, in f\n{line}\n         ^^^^^\n' for line in lines)
    return StudentError(type=kind, message=message, line=17, traceback=f"T\n{frames}{kind}: {message}\n")
