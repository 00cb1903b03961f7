"""Attack: a system call of the x32 table.

Expected: forbidden SIGSYS
"""

import ctypes

ctypes.CDLL(None).syscall(ctypes.c_long(0x40000000 | 41), 2, 1, 0)
