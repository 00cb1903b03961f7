"""The floor of every comparison: the graded car's body, stepped by nothing but a loop."""

import sys

from grader.sim.bullet import CarBody


class BareLoop:
    """Drives the body in a circle for as many physics steps as asked."""

    def __init__(self) -> None:
        self._body = CarBody()

    def run(self, steps: int) -> None:
        """Build the world anew and step it."""
        self._body.reset()
        self._body.run_bare(steps, v_mps=1.0, w_radps=0.5)


if __name__ == "__main__":
    BareLoop().run(int(sys.argv[1]))
