"""Attack: sleep for a few milliseconds at a time and send a frame after each, so that only the wall clock runs.

Expected: stalled
"""

import ctypes

libc = ctypes.CDLL(None)
while True:
    libc.usleep(3000)
    frame(b"still here")  # noqa: F821
