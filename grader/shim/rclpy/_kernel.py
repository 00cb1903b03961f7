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

import _thread

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import NoReturn, Protocol

    class World(Protocol):
        """What the kernel needs of the link to the episode."""

        coupled: bool
        quiet_ns: int
        reckons: bool

        def deliver_pose(self) -> tuple[int, ...]:
            """Deliver the pose that is due at `quiet_ns`, if the world `reckons`; return who got it."""

        def advance(self, target_ns: int, together_ns: int) -> int:
            """Run the world to the first event up to `target_ns`, deliver it, return the instant reached.

            Everything due up to `together_ns` is delivered at once. Afterwards nothing is due before `quiet_ns`.
            """

    class Sentinel(Protocol):
        """A lock that somebody who joins a thread waits for."""

        def locked(self) -> bool:
            """Return whether it is held."""

        def release(self) -> None:
            """Release it."""


FOREVER_NS = 1 << 62
"""Deadline of a wait that only its condition can end: 146 years, as a small integer of 64 bits."""

CHARGE_NS = 1_000
"""Virtual time that reading a clock, publishing or polling takes: about as much as on a PC.

It must not be 0: two readings of a clock must differ, and ``while time.time() < end: pass`` must end."""

CHARGE_STEPS = ((1_000, CHARGE_NS), (5_000, 10_000), (20_000, 100_000))
"""(operations since the last blocking wait, charge in ns up to there); `CHARGE_MAX_NS` beyond the last.

At 1 us each, a script that waits a second in a busy loop would read the clock a million times, which takes seconds
of CPU time. Since the charge grows, it reads it some 15,000 times. The first thousand operations stay at 1 us: a
callback that reads the clock now and then must not become late by that."""

CHARGE_MAX_NS = 1_000_000
"""The last step is as long as a slice: shorter than a pose's 16 ms, so a busy loop on the pose sees each one."""

TIMER_SLACK_NS = 50_000
"""Shortest real sleep: Linux' default timer slack (prctl(2), PR_SET_TIMERSLACK)."""

SLICE_NS = 1_000_000
"""Virtual time after which a thread that never blocks lets the others run.

The world is asked as often (`_pause`), so this also bounds how late a message reaches a busy loop."""

SPINS_PER_SLICE = 1_000
"""Turns of a loop that neither blocks nor polls, after which the others run: a slice, were each turn charged."""

STEPS_PER_SPIN = 100
"""How many steps `SPINS_PER_SLICE` turns of a loop count as, if nothing but the loop can end itself.

That includes a loop in a thread after the main thread has ended. If time passes beside the loop, they count a
tenth: a script may wait in a busy loop for a thread that runs at 1 kHz."""

HAND_OVER_STEPS = 3
"""How many steps a change to another thread counts as, besides the wait that led to it.

It takes up to 100 us, because the system switches threads. With this count, all granted steps together take a
script with threads no longer than others, and far less than the granted CPU time."""

GRACE_STEPS = 10
"""After Ctrl+C a script may use one part in so many of its steps."""

GRACE_NS = 10_000_000_000
"""Virtual time between the first Ctrl+C, the second one and the end.

Long enough for a script that stops the turtle and waits for it before it leaves."""

FIRST_IDENT = 0x7F00_0000_1000
"""Thread identifiers look like Linux' but are the same in each run."""

IDENT_STEP = 0x1000
MAX_THREADS = 64
"""As many as the sandbox's limit on processes leaves; one more is "can't start new thread" on every host."""

SIGINT = 2
SIGALRM = 14


class StalledError(RuntimeError):
    """Every thread waits for something that can never happen. The text names the calls."""


class Thread:
    """A thread known to the kernel, and what it waits for while it is blocked.

    Attributes:
        name: for the sentence that explains a stall.
        ready: whether the awaited condition holds; cheap, free of side effects.
        deadline_ns: instant at which the wait ends anyway.
        why: the student's call, or empty when only the stack can tell.
        idle: waiting for ever is normal here (a spinning node), not a stall.
        ident: what the script sees as `threading.get_ident()`; os_ident: the true one.
        sentinel: released when the thread has ended.
        program: which of several programs of a launch it belongs to; None: there is but one.
    """

    __slots__ = (
        "baton",
        "daemon",
        "deadline_ns",
        "ident",
        "idle",
        "name",
        "os_ident",
        "program",
        "ready",
        "sentinel",
        "streak",
        "why",
    )

    def __init__(self, name: str, ident: int, daemon: bool = False) -> None:
        self.name = name
        self.ident = ident
        self.os_ident = _get_ident()
        self.daemon = daemon
        self.sentinel: Sentinel | None = None
        self.baton = _allocate_lock()
        self.baton.acquire()
        self.ready: Callable[[], bool] = _always
        self.deadline_ns = FOREVER_NS
        self.why = ""
        self.idle = False
        self.streak = 0
        self.program: object = None


def _always() -> bool:
    return True


def never() -> bool:
    """Return False: the condition of a wait that only time ends."""
    return False


def _nothing() -> None:
    pass


def _no_switch(old: object, new: object) -> None:
    pass


def _once(act: Callable[[], None]) -> None:
    act()


class Kernel:
    """Clock and scheduler of the student's process; use the module's one object `kernel`.

    Attributes:
        now_ns: current virtual time; reading it is free.
        epoch_ns: wall clock at virtual time 0, nanoseconds since 1970.
        horizon_ns: virtual instant of Ctrl+C.
        interrupted: whether Ctrl+C has come, which it does at the horizon.
        ends_early: whether it came before, from the script's own launch file.
        main_ended: whether the main thread does no more than wait for the end of the others.
        running: the thread that runs.
        threads: those alive, in order of creation; the first is the main thread.
        deliver: called in the main thread with the number of a signal that arrived there.
        on_terminate: called instead of ending the run when SIGTERM arrives and the script has no handler.
        switch: called with two programs when the turn passes from a thread of one to a thread of the other; calls
            nothing but code in C, so that no recursion limit ends it half-way.
        everywhere: calls a function once in each program.
        called: main threads of other programs than the running one at which a signal has arrived.
        steps: what the script has done so far: its waits, the callbacks it was given, its questions up to the last
            wait, its turns of loops, and turns of its threads.
        end: called (in any thread) with the exit reason when the run cannot go on; does not return.
    """

    def __init__(self) -> None:
        self.now_ns = 0
        self.epoch_ns = 0
        self.horizon_ns = FOREVER_NS
        self.interrupted = False
        self.ends_early = False
        self.main = Thread("main thread", FIRST_IDENT)
        self.main_ended = False
        self.running = self.main
        self.threads = [self.main]
        self.deliver: Callable[[int], None] = _raise_keyboard_interrupt
        self.at_horizon: Callable[[], None] = _nothing
        self.on_terminate: Callable[[], None] | None = None
        self.end: Callable[[str], NoReturn] = _raise_stalled
        self.switch: Callable[[object, object], None] = _no_switch
        self.everywhere: Callable[[Callable[[], None]], None] = _once
        self.called: list[Thread] = []
        self.steps = 0
        self._most_steps = FOREVER_NS
        self._world: World | None = None
        self._limit_ns = FOREVER_NS
        self._ctrl_c_ns = FOREVER_NS
        self._alarm_ns = FOREVER_NS
        self._signals: list[int] = []
        self._started = 0
        self._on_interrupt: list[Callable[[], None]] = []
        self._streak = 0
        self._spent_ns = 0
        self._spins = SPINS_PER_SLICE
        self._quiet_until_ns = FOREVER_NS
        self._preempt_ns = FOREVER_NS
        self._slices = False
        self._slice_end_ns = 0
        self._holds = False  # whether the condition of the thread chosen last was found to hold
        # What `replan` found: the first signal, and the world if time only depends on it and the one thread.
        self._bound_ns = FOREVER_NS
        self._lone_world: World | None = None

    # Interface for the rest of the shim ------------------------------------------------------------

    def clock_ns(self) -> int:
        """Return the time as a student's look at a clock: it costs a charge."""
        self.charge()
        return self.now_ns

    @property
    def streak(self) -> int:
        """Charges since a thread waited last."""
        return self._streak

    def charge(self) -> None:
        """Advance time by the charge of one publish, poll or reading of a clock.

        Raises:
            KeyboardInterrupt: in the main thread, when the horizon is reached.
        """
        self._streak = streak = self._streak + 1
        self._spins = SPINS_PER_SLICE  # time passes here already: a checkpoint need not let it pass as well
        if streak <= 1_000:  # the first of `CHARGE_STEPS`, inlined: this runs at each look and each publish
            self.now_ns += CHARGE_NS
            self._spent_ns += CHARGE_NS
        else:
            self.now_ns += charge_of(streak)
        if self.now_ns >= self._preempt_ns:
            self._pause()

    def poll(self, count: int) -> None:
        """Advance time by the charge of poll number `count` for one thing.

        The charge grows ten times as fast as that of `charge`, and waits of others do not reset it: in an asyncio
        loop one task may poll for ever while another sleeps for a millisecond at a time.
        """
        self.now_ns += charge_of(count * 10)
        if self.now_ns >= self._preempt_ns:
            self._pause()

    def be_late(self, most_ns: int) -> None:
        """Advance time by the lateness of a periodic wake-up: the sum of all charges so far, modulo `most_ns`.

        A script that notes the time in one tick and asks `elapsed >= 2.0` in a later one has read the clock later
        within the first tick than within the second. If every tick began exactly on time, the difference would
        always be some microseconds short, and every phase of the script one period too long; at home chance
        decides. If each tick is later than the last, a whole number of periods is never short.

        At `most_ns` the lateness starts again from 0; 0: never late.
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
        # Nothing else can happen until `_quiet_until_ns`: most scripts sleep here, without the scheduler's cost.
        if target_ns < self._quiet_until_ns:
            self._skip_to(target_ns)
        else:
            self.wait(never, target_ns, "sleep()")

    def wait(
        self, ready: Callable[[], bool], deadline_ns: int | None = None, why: str = "", *, idle: bool = False
    ) -> bool:
        """Block the calling thread until `ready()` holds or the deadline has passed.

        Args:
            ready: cheap, free of side effects; may be asked in any thread.
            deadline_ns: virtual instant, None: for ever.
            why: the student's call and what it waits for; empty: the call is found on the stack.
            idle: waiting for ever is this call's normal state (spin): the horizon ends it, it is no stall.

        Returns:
            True when `ready()` holds, False when the deadline passed first.

        Raises:
            KeyboardInterrupt: in the main thread, when the horizon is reached.
        """
        if ready():
            self.charge()
            if ready():  # the charge may have let another thread run
                return True
        if deadline_ns is not None and self.now_ns < deadline_ns < self._quiet_until_ns:
            self._skip_to(deadline_ns)
            return ready()
        if blocks := deadline_ns is None or deadline_ns > self.now_ns:
            self._count()
            self._spins = SPINS_PER_SLICE
        else:
            self.charge()  # a timeout of 0 does not block: a loop that polls must let time pass
            if len(self.threads) == 1 and not self._signals:
                return ready()
        me = self.running
        before = (me.ready, me.deadline_ns, me.why, me.idle)
        me.ready, me.why, me.idle = ready, why, idle
        me.deadline_ns = FOREVER_NS if deadline_ns is None else deadline_ns
        try:
            return self._block(me, asked=blocks)
        finally:
            # A destructor run by the garbage collector may wait inside another wait.
            me.ready, me.deadline_ns, me.why, me.idle = before

    def skip_to_tick(self, due_ns: int, late_ns: int) -> bool:
        """Jump to a periodic wake-up at `due_ns` if nothing else can happen before it.

        This is a fast path for `wait` and `be_late(late_ns)`.

        Returns:
            Whether it jumped; if not, nothing was done, and the caller must `wait`.
        """
        if self.now_ns >= due_ns or due_ns + late_ns >= self._quiet_until_ns:
            return False
        self.now_ns = now_ns = due_ns
        self._count()
        self._spins = SPINS_PER_SLICE
        if late_ns:
            self.now_ns = now_ns = due_ns + self._spent_ns % late_ns
        self._slice_end_ns = (due_ns if now_ns < due_ns + SLICE_NS else now_ns) + SLICE_NS
        if self._slices:
            self._preempt_ns = min(self._limit_ns, self._alarm_ns, self._slice_end_ns)
        return True

    def skip_to_pose(self, ready: Callable[[], bool], before_ns: int) -> tuple[int, ...]:
        """Jump to the next pose that is computed here (`_reckoning`), if nothing else can happen before it.

        Returns:
            The subscriptions that got it. Nobody: it did not jump, nothing was done, and the caller must `wait`.
            It does not if no pose is computed here, if the next one is due at `before_ns` or later, if another
            thread, a signal or an alarm may come first, or if `ready()` holds.
        """
        world = self._lone_world
        if world is None or not world.reckons:
            return ()
        pose_ns = world.quiet_ns
        limit_ns = self._bound_ns
        if not self.now_ns < pose_ns < before_ns or pose_ns >= limit_ns or ready():
            return ()
        heard = world.deliver_pose()
        self.now_ns = pose_ns
        self._count()
        self._spins = SPINS_PER_SLICE
        self._slice_end_ns = end_ns = pose_ns + SLICE_NS
        quiet_ns = world.quiet_ns
        self._slices = True
        self._quiet_until_ns = quiet_ns if quiet_ns < limit_ns else limit_ns
        self._preempt_ns = end_ns if end_ns < limit_ns else limit_ns
        return heard

    def on_interrupt(self, callback: Callable[[], None]) -> None:
        """Have `callback` run at each Ctrl+C, before KeyboardInterrupt."""
        self._on_interrupt.append(callback)

    # For the patches and the runner ----------------------------------------------------------------

    def connect(self, world: World) -> None:
        """Take `world` as the other end of time."""
        self._world = world
        self.replan()

    def start_episode(self, horizon_ns: int, epoch_ns: int, most_steps: int | None = None) -> None:
        """Begin at virtual time 0. A script that makes more than `most_steps` is ended."""
        if most_steps is not None:
            self._most_steps = most_steps
        self.horizon_ns = self._limit_ns = self._ctrl_c_ns = horizon_ns
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

        Raises RuntimeError: there are `MAX_THREADS` already.
        """
        if len(self.threads) >= MAX_THREADS:
            raise RuntimeError("can't start new thread")
        self._started += 1
        thread = Thread(name, FIRST_IDENT + self._started * IDENT_STEP, daemon)
        thread.program = self.running.program
        return thread

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
        """Deliver a signal to the main thread."""
        if number == SIGINT:
            # At once, as upstream's C handler does it; KeyboardInterrupt waits for the main thread.
            self._tell_of_interrupt()
        self._signals.append(number)
        self.replan()
        if self.running is self.main:
            self._deliver()

    def set_alarm(self, instant_ns: int | None) -> None:
        """Schedule SIGALRM for `instant_ns`; None: cancel it."""
        self._alarm_ns = FOREVER_NS if instant_ns is None else instant_ns
        self.replan()

    def forget_interrupt_callbacks(self) -> None:
        """Run none of the callbacks registered so far: the script has replaced the handler of SIGINT."""
        self._on_interrupt.clear()

    # Turns and time ---------------------------------------------------------------------------------

    def replan(self) -> None:
        """Recompute up to when the running thread may go on without a look at the others.

        Whatever changes the threads, the signals, the alarm or the coupling calls this afterwards: `charge` and
        `sleep_ns` compare with these two instants and look at nothing else.
        """
        limit_ns = min(self._limit_ns, self._alarm_ns)
        if self._signals:
            limit_ns = 0  # the next charge must come to `_pause`, which delivers them
        self._bound_ns = limit_ns
        self._slices = True
        if len(self.threads) > 1:
            self._lone_world = None
            self._quiet_until_ns = 0  # every sleep goes through the scheduler
            others_ns, running = FOREVER_NS, self.running
            for thread in self.threads:
                if thread.deadline_ns < others_ns and thread is not running:
                    others_ns = thread.deadline_ns
            if others_ns <= self.now_ns:
                # one that is due keeps no other from the operation it is about to do
                others_ns = self.now_ns + 1
            self._preempt_ns = min(limit_ns, self._slice_end_ns, others_ns)
            return
        self._lone_world = world = self._coupled()
        if world is not None:
            self._quiet_until_ns = min(limit_ns, world.quiet_ns)
            self._preempt_ns = min(limit_ns, self._slice_end_ns)
        else:
            self._slices = False
            self._quiet_until_ns = self._preempt_ns = limit_ns

    def _count(self) -> None:
        """Count a wait and the questions before it, which end the streak."""
        self.steps += self._streak + 1
        self._streak = 0
        if self.steps > self._most_steps:
            self.end("steps")

    def _skip_to(self, target_ns: int) -> None:
        """End a wait without the scheduler: this thread is alone, and nothing is due before `target_ns`."""
        self.now_ns = target_ns
        self._count()
        self._spins = SPINS_PER_SLICE
        self._begin_slice()

    def _begin_slice(self) -> None:
        """Begin a slice in a thread that is alone while the world is quiet: nobody has to be looked at."""
        self._slice_end_ns = self.now_ns + SLICE_NS
        if self._slices:
            self._preempt_ns = min(self._limit_ns, self._alarm_ns, self._slice_end_ns)

    def _block(self, me: Thread, *, asked: bool = False) -> bool:
        if len(self.threads) == 1 and (ended := self._block_alone(me, asked=asked)) is not None:
            return ended
        while True:
            chosen = self._choose(self.threads.index(me), me if asked else None)
            asked = False
            if chosen is not me:
                self._hand_over(chosen)
                me.baton.acquire()
            self.replan()
            # Signals come before the condition, as in Python: Ctrl+C interrupts a wait that could end just now.
            if self._signals and me is self.main:
                self._deliver()
                self._holds = False
            # The condition comes before the deadline: what arrived in time is not reported as a timeout.
            if self._holds or me.ready():
                return True
            if me.deadline_ns <= self.now_ns:
                return False

    def _block_alone(self, me: Thread, *, asked: bool) -> bool | None:
        """Do what `_block` does for the only thread there is; None: `_block` has to go on.

        It delivers a signal that has come, and lets a thread run that a destructor has started meanwhile.

        `asked`: `me.ready()` has just been asked, and did not hold.
        """
        while not self._signals and len(self.threads) == 1:
            if asked:
                asked = False
            elif me.ready():
                self.replan()
                return True
            elif me.deadline_ns <= self.now_ns:
                self.replan()
                return False
            self._pass_time(min(self._alarm_ns, me.deadline_ns), me.ready is never)
        return None

    def _choose(self, position: int, asked: Thread | None = None) -> Thread:
        """Return the thread to run after the one at `position`, letting time pass until there is one.

        `asked`: its condition has just been asked, and did not hold.
        """
        self._holds = False
        while True:
            threads = self.threads
            if self._signals:
                return self.main  # only the main thread handles signals, whatever it waits for
            if self.called:
                return self.called.pop(0)
            now_ns, target_ns = self.now_ns, self._alarm_ns
            asleep = True  # then nobody looks at what comes before
            # Round robin from the one after the last: the first in the list alone would starve the others.
            turn = position + 1
            for thread in threads if len(threads) == 1 else (*threads[turn:], *threads[:turn]):
                deadline_ns, ready = thread.deadline_ns, thread.ready
                if deadline_ns <= now_ns:
                    return thread
                if ready is not never:
                    if thread is not asked and ready():
                        self._holds = True
                        return thread
                    asleep = False
                target_ns = min(target_ns, deadline_ns)
            asked = None
            self._pass_time(target_ns, asleep)

    def _hand_over(self, chosen: Thread) -> None:
        # Nothing in here can fail half-way, not even with RecursionError; `chosen` makes the new plan.
        if chosen.program is not self.running.program:
            self.switch(self.running.program, chosen.program)
        self._quiet_until_ns = self._preempt_ns = 0
        self.steps += HAND_OVER_STEPS
        self.running.streak = self._streak
        self.running = chosen
        self._streak = chosen.streak
        chosen.baton.release()

    def _pass_time(self, target_ns: int, asleep: bool) -> None:
        """Nobody can run: move time to `target_ns`, when the first deadline comes, or to what happens before.

        `asleep`: nobody looks at what comes before.
        """
        world = self._coupled()
        # While the world is coupled something may still arrive, and a spinning node may idle until the horizon.
        if target_ns == FOREVER_NS and world is None and not any(thread.idle for thread in self.threads):
            self.end("stalled")
        target_ns = min(target_ns, self._limit_ns)
        if world is not None and world.reckons and not asleep and self.now_ns < world.quiet_ns < target_ns:
            # a shortcut for what `_move_to` would do with every pose that is computed here
            pose_ns = world.quiet_ns
            world.deliver_pose()
            self.now_ns = pose_ns
            self._slice_end_ns = pose_ns + SLICE_NS
        else:
            self._move_to(target_ns, target_ns if asleep else 0)

    def _coupled(self) -> World | None:
        """Return the world if time may only move with its consent; after Ctrl+C it is not asked any more."""
        world = self._world
        goes_on = self.ends_early or not self.interrupted
        return world if world is not None and world.coupled and goes_on else None

    def _move_to(self, target_ns: int, together_ns: int = 0) -> None:
        """Advance time to `target_ns`, or to the first event before it that is later than `together_ns`."""
        world, now_ns = self._coupled(), self.now_ns
        if world is not None:
            asked_ns = target_ns if target_ns > now_ns else now_ns
            if world.quiet_ns <= asked_ns:
                target_ns = world.advance(asked_ns, together_ns)
        if target_ns > now_ns:  # charges may have gone past the instant the world reached
            self.now_ns = target_ns
        self._slice_end_ns = self.now_ns + SLICE_NS
        self._on_time()

    def _on_time(self) -> None:
        """Send the signals that are due."""
        if self.now_ns >= self._alarm_ns:
            self._alarm_ns = FOREVER_NS
            self._signals.append(SIGALRM)
        if self.now_ns >= self._limit_ns:
            self._interrupt()

    def interrupt(self) -> None:
        """Let Ctrl+C come now, and not from outside at the horizon: the world goes on."""
        self.ends_early = True
        self._ctrl_c_ns = self._limit_ns = self.now_ns
        self._interrupt()

    def _interrupt(self) -> None:
        if self._limit_ns >= self._ctrl_c_ns + 2 * GRACE_NS:
            self.end("interrupted")
        self._limit_ns += GRACE_NS
        if not self.interrupted:
            self._most_steps = min(self._most_steps, self.steps + self._most_steps // GRACE_STEPS)
            # Before anything of the script runs: it may use up its CPU time meanwhile.
            if not self.ends_early:
                self.at_horizon()
        self.interrupted = True
        self.everywhere(self._take_interrupt)

    def _take_interrupt(self) -> None:
        self._tell_of_interrupt()  # the contexts are shut down before KeyboardInterrupt is seen, as upstream
        self._signals.append(SIGINT)

    def _tell_of_interrupt(self) -> None:
        for callback in self._on_interrupt:
            callback()

    def _pause(self) -> None:
        """A charge went past the end of the slice: catch up with the world, let the others run."""
        if self.now_ns < self._quiet_until_ns:
            self._begin_slice()
            return
        world = self._coupled()
        if world is not None:
            # Charges may have gone past the horizon; the world ends there and takes no later instant.
            target_ns = min(self.now_ns, self.horizon_ns)
            while world.quiet_ns <= target_ns:
                world.advance(target_ns, target_ns)
        self._slice_end_ns = self.now_ns + SLICE_NS
        self._on_time()
        self._yield()

    def _yield(self) -> None:
        me = self.running
        before = (me.ready, me.deadline_ns)
        me.ready = _always
        try:
            self._block(me)
        finally:
            me.ready, me.deadline_ns = before

    def _spin(self) -> None:
        """A loop has gone round `SPINS_PER_SLICE` times: if it may wait for others, let time pass."""
        self._spins = SPINS_PER_SLICE
        others_ns = min((t.deadline_ns for t in self.threads if t is not self.running), default=FOREVER_NS)
        alone = not self._slices or (self.main_ended and others_ns == FOREVER_NS and self._is_left_alone())
        self.steps += STEPS_PER_SPIN if alone else STEPS_PER_SPIN // 10
        if self.steps > self._most_steps:
            self.end("steps")
        if alone:
            return  # and uncoupled: nothing can change what the loop waits for, and computing takes no time
        self._streak += 1
        slice_ns = charge_of(self._streak) * SPINS_PER_SLICE
        self._move_to(max(self.now_ns, min(self.now_ns + slice_ns, others_ns, self._limit_ns)))
        self._yield()

    def _is_left_alone(self) -> bool:
        """Return whether nothing but this thread can act now: no other thread, no signal, not the world."""
        others = (thread for thread in self.threads if thread is not self.running)
        return (
            self._coupled() is None
            and not self.interrupted
            and self._alarm_ns == FOREVER_NS
            and not any(thread.ready() for thread in others)
        )

    def _deliver(self) -> None:
        while self._signals:
            number = self._signals.pop(0)
            self.replan()  # before the handler, which may sleep, charge or raise
            self.deliver(number)


def charge_of(streak: int) -> int:
    """Return the charge of the operation number `streak` since the last blocking wait."""
    for operations, charge_ns in CHARGE_STEPS:
        if streak <= operations:
            return charge_ns
    return CHARGE_MAX_NS


def _raise_keyboard_interrupt(number: int) -> None:
    if number == SIGINT:
        raise KeyboardInterrupt


def _raise_stalled(reason: str) -> NoReturn:
    raise StalledError(reason)


_allocate_lock = _thread.allocate_lock
_get_ident = _thread.get_ident

kernel = Kernel()

charge, skip_to_pose = kernel.charge, kernel.skip_to_pose
"""What is called most: Python 3.11 looks up methods of imported objects anew at each call, but not functions."""
