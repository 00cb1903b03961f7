"""Signals and timers in virtual time: no signal of the operating system is ever involved.

A signal is delivered in the main thread: at once when that thread runs, otherwise out of whatever it waits
in; when the handler returns, the wait goes on (PEP 475).
"""

from __future__ import annotations

import os
import signal
import sys

from rclpy._kernel import kernel
from rclpy._patches.time import seconds_to_ns

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType, ModuleType
    from typing import Any

    Handler = Callable[[int, FrameType | None], Any] | int | None


_IGNORED_BY_DEFAULT = frozenset({signal.SIGCHLD, signal.SIGCONT, signal.SIGURG, signal.SIGWINCH})
_UNCATCHABLE = frozenset({signal.SIGKILL, signal.SIGSTOP})


class Signals:
    """The table of handlers, the interval timer and the wake-up descriptor of the process."""

    def __init__(self) -> None:
        self.handlers: dict[int, Handler] = {signal.SIGINT: signal.default_int_handler}
        self.handlers[signal.SIGPIPE] = signal.SIG_IGN
        self.wakeup_fd = -1
        self.arrived = 0
        self.alarm_ns: int | None = None
        self.interval_ns = 0

    def deliver(self, number: int) -> None:
        """Run the handler of a signal in the main thread."""
        self.arrived += 1
        if number == signal.SIGALRM:
            self._rearm()
        handler = self.handlers.get(number, signal.SIG_DFL)
        if handler == signal.SIG_IGN:
            return
        if callable(handler):
            if self.wakeup_fd >= 0:
                os.write(self.wakeup_fd, bytes([number]))
            handler(number, _student_frame())
        elif number == signal.SIGTERM and kernel.on_terminate is not None:
            kernel.on_terminate()
        elif number not in _IGNORED_BY_DEFAULT:
            kernel.end(f"signal {number}")

    def _rearm(self) -> None:
        """Set the next deadline on the timer's own grid of intervals, however late the last one was delivered."""
        if self.interval_ns and self.alarm_ns is not None:
            late_ns = kernel.now_ns - self.alarm_ns
            self.set_timer(self.interval_ns - late_ns % self.interval_ns, self.interval_ns)
        else:
            self.set_timer(None, 0)

    def set_timer(self, delay_ns: int | None, interval_ns: int) -> None:
        """Schedule SIGALRM after `delay_ns` (None: never) and then every `interval_ns` (0: once)."""
        self.alarm_ns = None if delay_ns is None else kernel.now_ns + delay_ns
        self.interval_ns = interval_ns
        kernel.set_alarm(self.alarm_ns)

    def timer(self) -> tuple[int, int]:
        """Return the nanoseconds until the next SIGALRM (0: none) and the interval."""
        left_ns = 0 if self.alarm_ns is None else max(1, self.alarm_ns - kernel.now_ns)
        return left_ns, self.interval_ns


signals = Signals()


def _student_frame() -> FrameType | None:
    frame: FrameType | None = sys._getframe(1)
    while frame is not None and frame.f_globals.get("__name__", "").startswith("rclpy._"):
        frame = frame.f_back
    return frame


def _check_number(number: int) -> int:
    number = int(number)
    if not 1 <= number < signal.NSIG:
        raise ValueError("signal number out of range")
    return number


def set_handler(signalnum: int, handler: Handler, /) -> Handler:
    """`signal.signal`; a new handler of SIGINT takes the place of rclpy's, as on ROS 2."""
    number = _check_number(signalnum)
    if kernel.running is not kernel.main:
        raise ValueError("signal only works in main thread of the main interpreter")
    if not callable(handler) and handler not in (signal.SIG_IGN, signal.SIG_DFL):
        raise TypeError("signal handler must be signal.SIG_IGN, signal.SIG_DFL, or a callable object")
    if number in _UNCATCHABLE:
        raise OSError(22, "Invalid argument")
    previous = getsignal(number)
    signals.handlers[number] = handler
    if number == signal.SIGINT:
        kernel.forget_interrupt_callbacks()
    return previous


def getsignal(signalnum: int, /) -> Handler:
    return signals.handlers.get(_check_number(signalnum), signal.SIG_DFL)


def raise_signal(signalnum: int, /) -> None:
    kernel.raise_signal(_check_number(signalnum))


def alarm(seconds: int, /) -> int:
    left_ns, _ = signals.timer()
    signals.set_timer(int(seconds) * 10**9 or None, 0)
    return -(-left_ns // 10**9)


def getitimer(which: int, /) -> tuple[float, float]:
    _check_timer(which)
    left_ns, interval_ns = signals.timer()
    return left_ns / 1e9, interval_ns / 1e9


def setitimer(which: int, seconds: float, interval: float = 0.0, /) -> tuple[float, float]:
    """Every timer counts virtual time and sends SIGALRM."""
    previous = getitimer(which)
    if seconds < 0 or interval < 0:
        raise signal.ItimerError(22, "Invalid argument")
    signals.set_timer(seconds_to_ns(seconds) or None, seconds_to_ns(interval))
    return previous


def _check_timer(which: int) -> None:
    if which not in (signal.ITIMER_REAL, signal.ITIMER_VIRTUAL, signal.ITIMER_PROF):
        raise signal.ItimerError(22, "Invalid argument")


def pause() -> None:
    """Wait for any signal; Ctrl+C at the horizon ends it too."""
    arrived = signals.arrived
    kernel.wait(lambda: signals.arrived != arrived, None, "signal.pause() waits for a signal", idle=True)


def sigtimedwait(sigset: Any, timeout: float, /) -> None:
    """Wait out the timeout: no signal is ever blocked here, so none can be pending."""
    kernel.sleep_ns(seconds_to_ns(timeout))


def set_wakeup_fd(fd: int, /, *, warn_on_full_buffer: bool = True) -> int:
    if kernel.running is not kernel.main:
        raise ValueError("set_wakeup_fd only works in main thread of the main interpreter")
    previous, signals.wakeup_fd = signals.wakeup_fd, fd
    return previous


def siginterrupt(signalnum: int, flag: bool, /) -> None:
    """Accept and ignore: no system call is interrupted here."""


def patch_signal(module: ModuleType) -> None:
    """Replace the module's functions and become the kernel's way to deliver signals."""
    for function in (
        getsignal,
        raise_signal,
        alarm,
        getitimer,
        setitimer,
        pause,
        sigtimedwait,
        set_wakeup_fd,
        siginterrupt,
    ):
        setattr(module, function.__name__, function)
    target: Any = module
    target.signal = set_handler
    kernel.deliver = signals.deliver
