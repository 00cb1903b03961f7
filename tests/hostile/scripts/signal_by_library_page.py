"""Attack: wake whoever waits in a page of a library that another run has mapped as well.

Expected: finished
"""

import ctypes
import os

libc = ctypes.CDLL(None, use_errno=True)
FUTEX = {"x86_64": 202, "aarch64": 98}[os.uname().machine]
WAKE, REQUEUE, CMP_REQUEUE, WAKE_OP, UNLOCK_PI, WAKE_BITSET = 1, 3, 4, 5, 7, 10
page = ctypes.cast(libc.getpid, ctypes.c_void_p).value & ~7
for operation in (WAKE, REQUEUE, CMP_REQUEUE, WAKE_OP, UNLOCK_PI, WAKE_BITSET):
    answer = libc.syscall(FUTEX, ctypes.c_void_p(page), operation, 1, None, ctypes.c_void_p(page), -1)
    print("held" if answer < 0 and ctypes.get_errno() == 1 else "BREACH", operation)
