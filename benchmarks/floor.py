"""The floor of every comparison: the graded car, stepped by nothing but a loop."""

import sys

from grader.sim.bullet import BulletCar
from grader.sim.car import PlanarPose


class _Nobody:
    """Watches the car without keeping anything."""

    def sample(self, t_ns: int, pose: PlanarPose, v_mps: float, w_radps: float) -> None:
        pass

    def jump(self, t_ns: int, pose: PlanarPose, v_mps: float, w_radps: float) -> None:
        pass

    def contact(self, start_ns: int, end_ns: int, wall: str) -> None:
        pass


class BareLoop:
    """Drives the car in a circle for as many physics steps as asked."""

    def __init__(self) -> None:
        self._car = BulletCar()

    def run(self, steps: int) -> None:
        """Build the world anew and step it."""
        self._car.reset(_Nobody(), (0.0, 0.0, 0.0), profile="nominal", walls=False, seed=0)
        self._car.run_bare(steps, v_mps=1.0, w_radps=0.5)


if __name__ == "__main__":
    BareLoop().run(int(sys.argv[1]))
