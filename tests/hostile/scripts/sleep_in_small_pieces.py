"""Attack: sleep in real time in small pieces, printing between them, to use up the wall clock of the host.

Expected: stalled
"""

import ctypes

libc = ctypes.CDLL(None)
while True:
    libc.usleep(20000)
    print("still here", flush=True)
