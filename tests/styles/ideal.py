"""An ideal turtle: obeys a list of velocities in updates of 16 ms, as turtlesim does. Knows no simulator."""

import math
from bisect import bisect_right
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Pose = tuple[float, float, float]  # m, m, rad

UPDATE_S = 0.016
START: Pose = (5.544445, 5.544445, 0.0)


@dataclass(frozen=True, slots=True)
class Leg:
    """The velocity (v, w) is held for `duration_s` from `start_s` on; between legs the turtle stands."""

    start_s: float
    duration_s: float
    v_mps: float = 0.0
    w_radps: float = 0.0


@dataclass(frozen=True, slots=True)
class Jump:
    """The turtle is put into `pose` at `start_s`."""

    start_s: float
    pose: Pose


@dataclass(frozen=True, slots=True)
class _Piece:
    start_s: float
    pose: Pose
    v_mps: float
    w_radps: float


class IdealTurtle:
    """Poses over time under `plan`, whose legs must not overlap."""

    def __init__(self, plan: tuple[Leg | Jump, ...]) -> None:
        self._pieces = [_Piece(-1.0, START, 0.0, 0.0)]
        for part in plan:
            start_s = _update_before(part.start_s)
            pose = self._at(start_s)
            if isinstance(part, Jump):
                self._pieces.append(_Piece(start_s, part.pose, 0.0, 0.0))
                continue
            self._pieces.append(_Piece(start_s, pose, part.v_mps, part.w_radps))
            end_s = _update_before(part.start_s + part.duration_s)
            self._pieces.append(_Piece(end_s, self._at(end_s), 0.0, 0.0))
        self._starts = [piece.start_s for piece in self._pieces]
        assert all(a <= b + 1e-9 for a, b in pairwise(self._starts)), "the legs overlap"
        self.path_length_m = sum(abs(leg.v_mps) * leg.duration_s for leg in plan if isinstance(leg, Leg))

    def poses(self, times_s: Floats) -> Floats:
        """Return x, y and unwrapped heading at each instant, shape (n, 3)."""
        return np.array([self._at(float(t), bisect_right(self._starts, float(t)) - 1) for t in times_s])

    def _at(self, t_s: float, index: int = -1) -> Pose:
        piece = self._pieces[index]
        dt = max(t_s - piece.start_s, 0.0)
        x, y, heading = piece.pose
        half, step = 0.5 * piece.w_radps * dt, 0.5 * piece.w_radps * UPDATE_S
        # The sum of the updates' moves; each turns first, so that the whole points half an update further.
        chord = piece.v_mps * UPDATE_S * (math.sin(half) / math.sin(step) if step else dt / UPDATE_S)
        middle = heading + half + step
        return x + chord * math.cos(middle), y + chord * math.sin(middle), heading + 2 * half


def _update_before(t_s: float) -> float:
    """Return the update from whose pose on a command of time `t_s` acts: the next one takes it."""
    return math.floor(t_s / UPDATE_S + 1e-6) * UPDATE_S
