"""Attack: read how much CPU time other processes of the host have used, and wait by their clocks.

Expected: finished
"""

import ctypes
import os
import time

libc = ctypes.CDLL(None, use_errno=True)
NOTHING = ctypes.create_string_buffer(16)
PROCESS, THREAD = 2, 6


def clock(number, kind):
    return ctypes.c_int((~number << 3) | kind)


for name in ("clock_gettime", "clock_getres"):
    found = [
        number
        for number in (1, os.getppid(), *range(2, 2_000))
        for kind in (PROCESS, THREAD)
        if getattr(libc, name)(clock(number, kind), NOTHING) == 0
    ]
    print("held:" if not found else f"BREACH: {found[:5]}", name)
print("held:" if libc.clock_nanosleep(clock(1, PROCESS), 0, NOTHING, None) == 1 else "BREACH:", "clock_nanosleep")
assert time.process_time() > 0 and time.thread_time() > 0 and time.monotonic() > 0
assert time.clock_gettime(time.CLOCK_BOOTTIME) > 0
frame(b"measured")
