"""Attack: leave the main thread alone, so that the process looks dead, while another sleeps for ever.

Expected: stalled
"""

import ctypes
import os

libc = ctypes.CDLL(None)
exit_of_one_thread = 60 if os.uname().machine == "x86_64" else 93
libc.pthread_create(ctypes.byref(ctypes.c_ulong()), None, libc.pause, None)
libc.usleep(10_000)  # let it fall asleep
libc.syscall(ctypes.c_long(exit_of_one_thread), ctypes.c_long(0))
