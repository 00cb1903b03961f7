"""Drive a recorded list of commands again, changed or not, on an ideal turtle: obeys at once, never slips."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from grader.contracts.trajectory import COMMAND_LIFE_NS, Command, Floats, Trajectory

_PERIOD_NS = 16_666_667
_MOVING = 1e-6


def replayed(recorded: Trajectory, commands: Sequence[Command]) -> Trajectory:
    """Return the motion from the recorded start pose under `commands`; the episode lasts at least as long."""
    if not commands:
        return recorded
    end_ns = max(recorded.end_ns, commands[-1].t_ns + COMMAND_LIFE_NS + _PERIOD_NS)
    starts, v, w = _stretches(commands, end_ns)
    times = np.unique(np.concatenate((np.arange(0, end_ns, _PERIOD_NS), starts, [end_ns])))
    index = np.searchsorted(starts, times[:-1], side="right") - 1
    steps_s = np.diff(times) * 1e-9
    speed, rate = v[index], w[index]
    heading = recorded.heading_rad[0] + np.concatenate(([0.0], np.cumsum(rate * steps_s)))
    half = rate * steps_s / 2.0
    chord = speed * steps_s * np.sinc(half / math.pi)
    return replace(
        recorded,
        t_ns=times,
        x_m=recorded.x_m[0] + np.concatenate(([0.0], np.cumsum(chord * np.cos(heading[:-1] + half)))),
        y_m=recorded.y_m[0] + np.concatenate(([0.0], np.cumsum(chord * np.sin(heading[:-1] + half)))),
        heading_rad=heading,
        v_mps=np.concatenate(([0.0], speed)),
        w_radps=np.concatenate(([0.0], rate)),
        commands=tuple(commands),
        contacts=(),
        jumps=(),
        end_ns=end_ns,
    )


def _stretches(commands: Sequence[Command], end_ns: int) -> tuple[np.ndarray, Floats, Floats]:
    """Return start times, v and w of stretches of constant velocity; one ends with its command's time."""
    stretches = [(0, 0.0, 0.0)]
    following = [command.t_ns for command in commands[1:]] + [end_ns]
    for command, next_ns in zip(commands, following, strict=True):
        stretches.append((command.t_ns, command.v_mps, command.w_radps))
        if next_ns - command.t_ns > COMMAND_LIFE_NS:
            stretches.append((command.t_ns + COMMAND_LIFE_NS, 0.0, 0.0))
    columns = list(zip(*stretches, strict=True))
    return np.array(columns[0], dtype=np.int64), np.array(columns[1]), np.array(columns[2])


def motion_of(command: Command) -> str:
    """Return what a command asks for: ``run``, ``turn``, ``arc`` or ``rest``."""
    drives, turns = abs(command.v_mps) > _MOVING, abs(command.w_radps) > _MOVING
    if drives:
        return "arc" if turns else "run"
    return "turn" if turns else "rest"
