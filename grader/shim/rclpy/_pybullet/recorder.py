"""Records a script's calls of PyBullet, sends them to the episode, and keeps the simulated time.

A script of this world ends at the horizon by whichever clock comes there first: that of its process, which
sleeping moves, or that of the simulation, which `stepSimulation` moves. A loop that never sleeps ends so as well.
"""

from __future__ import annotations

from rclpy._kernel import kernel
from rclpy._link import link
from rclpy._pybullet import calls

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from typing import Any

MOST_CALLS = 150_000
"""A minute of an arm whose nine motors are commanded at each step takes 144,000."""
MOST_BYTES = 15 * 1024 * 1024
FRAME_BYTES = 30_000
STEP_S = 1.0 / 240.0
"""Of the simulation, unless the script sets another one."""

_SECOND_NS = 1_000_000_000
_STEPS_PER_FRAME = 24


class Recorder:
    """Collects calls in batches; use the module's one object `recorder`.

    Attributes:
        active: whether calls still count: before Ctrl+C, and within the bounds.
        live: whether the simulation runs by itself as time passes (`setRealTimeSimulation`).
    """

    def __init__(self) -> None:
        self.active = True
        self.live = False
        self.step: Callable[[], object] = lambda: None  # takes one step of the simulation and records it
        self._calls = 0
        self._bytes = 0
        self._steps = 0  # since the last frame
        self._batch = bytearray()
        self._step_s = STEP_S
        self._simulated_s = 0.0
        self._live_since_ns = 0

    def begin(self) -> None:
        """Register for the end of the run; called once, when the script imports the module."""
        kernel.on_interrupt(self._stop)
        link.before_exit = self._stop

    def note(self, number: int, args: Sequence[Any], options: Mapping[str, Any]) -> None:
        """Record a call. Raises UnreadableError: an argument is nothing that PyBullet takes."""
        if not self.active or kernel.interrupted:
            return
        call = calls.encode(number, args, options)
        if self._calls == MOST_CALLS or self._bytes + len(call) > MOST_BYTES:
            link.note("bullet_too_many", str(self._calls))
            self._end()
            return
        self._calls += 1
        self._bytes += len(call)
        if len(self._batch) + len(call) > FRAME_BYTES:
            self._send()
        self._batch += call

    def stepped(self) -> None:
        """Charge for a step, and advance the simulated time by it."""
        if not self.active or kernel.interrupted:
            kernel.charge()
            return
        self._steps += 1
        if self._steps >= _STEPS_PER_FRAME:
            self._send()
        self._simulated_s += self._step_s
        if self._simulated_s * _SECOND_NS >= kernel.horizon_ns:
            self._end()
        else:
            kernel.charge()

    def set_step(self, seconds: float) -> None:
        """Take what a step lasts."""
        self._step_s = seconds

    def set_live(self, live: bool) -> None:
        """Switch the real-time simulation on or off, in which the simulation runs by itself."""
        self.catch_up()
        self.live = live
        self._live_since_ns = kernel.now_ns

    def catch_up(self) -> None:
        """Take the steps of the time that has passed while the simulation ran by itself."""
        step_ns = max(round(self._step_s * _SECOND_NS), 1)
        now_ns = min(kernel.now_ns, kernel.horizon_ns)
        while self.live and self.active and now_ns - self._live_since_ns >= step_ns:
            self._live_since_ns += step_ns
            self.step()

    def _end(self) -> None:
        """Raise Ctrl+C now, as at the horizon."""
        self._stop()
        kernel.sleep_ns(kernel.horizon_ns - kernel.now_ns)

    def _stop(self) -> None:
        """Send what is there; what comes later does not count."""
        self.catch_up()
        self.active = False
        self._send()

    def _send(self) -> None:
        if self._batch:
            link.calls(bytes(self._batch))
            self._batch.clear()
        self._steps = 0


recorder = Recorder()
