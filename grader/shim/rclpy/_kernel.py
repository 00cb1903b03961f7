"""Virtual time: the one place where time advances and where threads take turns.

Contract (compare trio's MockClock with autojump):

- Time is an integer number of nanoseconds since the start of the episode. It moves only in here: to
  the next deadline when every thread is blocked, or by a small *charge* for a question or a publish.
  It never goes back.
- One student thread runs at a time. It keeps the processor until it blocks, until it has used up a
  slice of virtual time while others could run, or until it has gone round a `while` loop often enough.
  Which thread is next depends on nothing but the program, so a run can be repeated exactly.
- At the horizon the callbacks of `on_interrupt` run and the main thread sees Ctrl+C. A script that goes
  on gets a second Ctrl+C after `GRACE_NS` and is ended after another.
- When no thread can ever run again the run is *stalled*.

Not promised: that a computation takes any virtual time, or that time passes as evenly as on a PC.
"""

from __future__ import annotations

from rclpy._scheduler import (
    CHARGE_NS,
    FIRST_IDENT,
    FOREVER_NS,
    IDENT_STEP,
    MAX_THREADS,
    SIGINT,
    SPINS_PER_SLICE,
    TIMER_SLACK_NS,
    Scheduler,
    Thread,
    charge_of,
    never,
)

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy._protocols import World


class Kernel(Scheduler):
    """Clock and scheduler of the student's process; use the module's one object `kernel`."""

    # Interface for the rest of the shim ------------------------------------------------------------

    def clock_ns(self) -> int:
        """Return the time as a student's look at a clock: it costs a charge."""
        self.charge()
        return self.now_ns

    def charge(self) -> None:
        """Let the time pass that a publish or a question without blocking takes.

        Raises:
            KeyboardInterrupt: in the main thread, when the horizon is reached.
        """
        self._streak = streak = self._streak + 1
        self._spins = SPINS_PER_SLICE
        if streak <= 1_000:
            self.now_ns += CHARGE_NS
            self._spent_ns += CHARGE_NS
        else:
            self.now_ns += charge_of(streak)
        if self.now_ns >= self._preempt_ns:
            self._pause()

    def be_late(self, most_ns: int) -> None:
        """Let the time pass by which a periodic wake-up is late: as much as looks and publishes have cost so far.

        A script that begins a phase in one tick and asks `elapsed >= 2.0` in a later one compares a look at
        the clock with one that came later within its tick. If every tick began exactly in phase, the
        difference would always be some microseconds short, and every phase one period too long; at home
        chance decides. With ticks that are ever later, a whole number of periods is never short.

        Args:
            most_ns: where the lateness begins again at nothing; 0: never late.
        """
        if most_ns:
            self.now_ns += self._spent_ns % most_ns
            if self.now_ns >= self._preempt_ns:
                self._pause()

    def sleep_ns(self, duration_ns: int) -> None:
        """Block the calling thread for `duration_ns`; not positive: only a charge.

        Raises:
            KeyboardInterrupt: in the main thread, when the horizon is reached.
        """
        if duration_ns <= 0:
            self.charge()
            return
        target_ns = self.now_ns + (duration_ns if duration_ns > TIMER_SLACK_NS else TIMER_SLACK_NS)
        if target_ns < self._quiet_until_ns:
            self.now_ns = target_ns
            self._streak = 0
        else:
            self.wait(never, target_ns, "sleep()")

    def wait(
        self, ready: Callable[[], bool], deadline_ns: int | None = None, why: str = "", *, idle: bool = False
    ) -> bool:
        """Block the calling thread until `ready()` holds or the deadline has passed.

        Args:
            ready: cheap, free of side effects; may be asked in any thread.
            deadline_ns: virtual instant, None: for ever.
            why: the student's call and what it waits for, e.g. ``rate.sleep() waits for a timer, but
                nobody spins the node``; empty: the call is found on the stack.
            idle: whether waiting for ever is this call's normal state (spin): then the horizon ends it
                instead of a stall.

        Returns:
            True when `ready()` holds, False when the deadline passed first.

        Raises:
            KeyboardInterrupt: in the main thread, when the horizon is reached.
        """
        if ready():
            self.charge()
            if ready():  # the charge may have let another thread run
                return True
        me = self.running
        before = (me.ready, me.deadline_ns, me.why, me.idle)
        me.ready = ready
        me.deadline_ns = FOREVER_NS if deadline_ns is None else deadline_ns
        me.why = why
        me.idle = idle
        if me.deadline_ns <= self.now_ns:
            self.charge()
        else:
            self._streak = 0
            self._spins = SPINS_PER_SLICE
        try:
            return self._block(me)
        finally:
            # A destructor run by the garbage collector may wait inside another wait.
            me.ready, me.deadline_ns, me.why, me.idle = before

    def on_interrupt(self, callback: Callable[[], None]) -> None:
        """Have `callback` run at each Ctrl+C, before KeyboardInterrupt."""
        self._on_interrupt.append(callback)

    # For the patches and the runner ----------------------------------------------------------------

    def connect(self, world: World) -> None:
        """Take `world` as the other end of time."""
        self._world = world
        self.replan()

    def start_episode(self, horizon_ns: int, epoch_ns: int) -> None:
        """Begin at virtual time 0."""
        self.horizon_ns = self._limit_ns = horizon_ns
        self.epoch_ns = epoch_ns
        self.replan()

    def checkpoint(self) -> None:
        """Mark one turn of a `while` loop of the script.

        Raises:
            KeyboardInterrupt: in the main thread, when a signal is pending.
        """
        self._spins = spins = self._spins - 1
        if spins < 0:
            self._spin()

    def new_thread(self, name: str, daemon: bool) -> Thread:
        """Return a record for a thread that is about to start.

        Raises:
            RuntimeError: there are `MAX_THREADS` already.
        """
        if len(self.threads) >= MAX_THREADS:
            raise RuntimeError("can't start new thread")
        self._started += 1
        return Thread(name, FIRST_IDENT + self._started * IDENT_STEP, daemon)

    def start_thread(self, thread: Thread) -> None:
        """Make `thread` runnable; its OS thread waits for its baton."""
        self.threads.append(thread)
        self.replan()

    def end_thread(self, thread: Thread) -> None:
        """Take the running `thread` out and pass the baton on; the caller must not touch the kernel again."""
        if thread.sentinel is not None and thread.sentinel.locked():
            thread.sentinel.release()
        position = self.threads.index(thread)
        del self.threads[position]
        self._hand_over(self._choose(position - 1))

    def raise_signal(self, number: int) -> None:
        """Let a signal arrive at the main thread."""
        if number == SIGINT:
            self._tell_of_interrupt()
        self._signals.append(number)
        self.replan()
        if self.running is self.main:
            self._deliver()

    def set_alarm(self, instant_ns: int | None) -> None:
        """Let SIGALRM arrive at `instant_ns`; None: never."""
        self._alarm_ns = FOREVER_NS if instant_ns is None else instant_ns
        self.replan()

    def forget_interrupt_callbacks(self) -> None:
        """Run none of the callbacks registered so far: the script has replaced the handler of SIGINT."""
        self._on_interrupt.clear()


kernel = Kernel()
