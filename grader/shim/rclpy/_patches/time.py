"""The clocks and `time.sleep`."""

from __future__ import annotations

import _operator
import time

from rclpy._kernel import CHARGE_NS, kernel

TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import ModuleType
    from typing import Any

UPTIME_NS = 100_000 * 10**9
"""`time.monotonic()` at virtual time 0: like on a PC, far from 0 (`if monotonic() - last > 1` with last = 0)."""

_localtime, _gmtime, _strftime = time.localtime, time.gmtime, time.strftime
_ctime, _asctime = time.ctime, time.asctime
_clock_gettime_ns = time.clock_gettime_ns


def seconds_to_ns(seconds: Any) -> int:
    """Return whole nanoseconds, rounded to nearest; refuse what `time.sleep` refuses, in its words.

    CPython rounds up; to nearest keeps `sleep(0.07)` from taking 70 000 001 ns.
    """
    if isinstance(seconds, float):
        if seconds != seconds:  # noqa: PLR0124 - NaN
            raise ValueError("Invalid value NaN (not a number)")
        if not -9.2e9 < seconds < 9.2e9:
            raise OverflowError("timestamp too large to convert to C _PyTime_t")
        return round(seconds * 1e9)
    return int(_operator.index(seconds)) * 1_000_000_000


def sleep(seconds: Any, /) -> None:
    """Block for `seconds` of virtual time."""
    duration_ns = seconds_to_ns(seconds)
    if duration_ns < 0:
        raise ValueError("sleep length must be non-negative")
    kernel.sleep_ns(duration_ns)


def time_ns() -> int:
    return kernel.epoch_ns + kernel.clock_ns()


def time_s() -> float:
    return (kernel.epoch_ns + kernel.clock_ns()) / 1_000_000_000


def monotonic_ns() -> int:
    return UPTIME_NS + kernel.clock_ns()


def monotonic() -> float:
    return (UPTIME_NS + kernel.clock_ns()) / 1_000_000_000


_processor_ns = [0, 0]  # used so far; the instant at which that was read last


def process_time_ns() -> int:
    """Return the time that passed while nothing waited; in one stretch, all between two readings.

    A loop that waits and compares with it does not end at home, either. Of two readings with a wait between them,
    only what came after it counts, at the least it can have taken.
    """
    now_ns, (used_ns, before_ns) = kernel.clock_ns(), _processor_ns
    used_ns += min(now_ns - before_ns, kernel.streak * CHARGE_NS)
    _processor_ns[:] = used_ns, now_ns
    return used_ns


def process_time() -> float:
    return process_time_ns() / 1_000_000_000


def clock_gettime_ns(clock: int, /) -> int:
    if clock in (time.CLOCK_REALTIME, getattr(time, "CLOCK_TAI", -1)):
        return time_ns()
    if clock in (time.CLOCK_PROCESS_CPUTIME_ID, time.CLOCK_THREAD_CPUTIME_ID):
        return process_time_ns()
    if clock in (time.CLOCK_MONOTONIC, time.CLOCK_MONOTONIC_RAW, getattr(time, "CLOCK_BOOTTIME", -1)):
        return monotonic_ns()
    return _clock_gettime_ns(clock)


def clock_gettime(clock: int, /) -> float:
    return clock_gettime_ns(clock) / 1_000_000_000


def localtime(seconds: float | None = None, /) -> time.struct_time:
    return _localtime(time_s() if seconds is None else seconds)


def gmtime(seconds: float | None = None, /) -> time.struct_time:
    return _gmtime(time_s() if seconds is None else seconds)


def strftime(format: str, t: Any = None, /) -> str:
    return _strftime(format, localtime() if t is None else t)


def ctime(seconds: float | None = None, /) -> str:
    return _ctime(time_s() if seconds is None else seconds)


def asctime(t: Any = None, /) -> str:
    return _asctime(localtime() if t is None else t)


time_s.__name__ = time_s.__qualname__ = "time"


def patch_sched(sched: ModuleType) -> None:
    """Renew the clock and the sleep that `scheduler` takes by default."""
    module: Any = sched
    module.scheduler.__init__.__defaults__ = (monotonic, sleep)


REPLACED: dict[str, object] = {
    "sleep": sleep,
    "time": time_s,
    "time_ns": time_ns,
    "monotonic": monotonic,
    "monotonic_ns": monotonic_ns,
    "perf_counter": monotonic,
    "perf_counter_ns": monotonic_ns,
    "process_time": process_time,
    "process_time_ns": process_time_ns,
    "thread_time": process_time,
    "thread_time_ns": process_time_ns,
    "clock_gettime": clock_gettime,
    "clock_gettime_ns": clock_gettime_ns,
    "localtime": localtime,
    "gmtime": gmtime,
    "strftime": strftime,
    "ctime": ctime,
    "asctime": asctime,
}
"""What replaces the functions of `time`, by name."""
