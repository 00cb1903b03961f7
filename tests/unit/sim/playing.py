"""Playing a script of frames against a real episode."""

from typing import Any

from grader.contracts.assignment import World
from grader.sim.driving import Car
from grader.sim.episode import Episode, EpisodeResult, EpisodeSpec
from tests.fakes.jail import SECOND, FakeLink

OPEN = World(walls=False, odometry=True)


def play(
    car: Car, frames: Any, *, world: World = OPEN, horizon_s: float = 60.0, **fields: Any
) -> EpisodeResult:
    spec = EpisodeSpec(
        world=world, horizon_ns=round(horizon_s * SECOND), source=b"print()", file_name="a.py", **fields
    )
    return Episode(spec, car).run(FakeLink(frames))


def end_pose(result: EpisodeResult) -> tuple[float, float, float]:
    path = result.trajectory
    return (
        float(path.x_m[-1] - path.x_m[0]),
        float(path.y_m[-1] - path.y_m[0]),
        float(path.heading_rad[-1] - path.heading_rad[0]),
    )
