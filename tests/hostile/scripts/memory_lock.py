"""Attack: lock memory into RAM.

Expected: finished
"""

import ctypes

libc = ctypes.CDLL(None, use_errno=True)

def lock():
    area = ctypes.create_string_buffer(1 << 20)
    if libc.mlock(area, len(area)) or libc.mlockall(3):
        raise OSError(ctypes.get_errno(), "mlock")

attempt("mlock", lock)
