"""Attack: make processes with raw system calls, clone and clone3 with each kind of flag.

Expected: finished
"""

import ctypes
import os
import platform

libc = ctypes.CDLL(None, use_errno=True)
CLONE, CLONE3, VFORK = (56, 435, 58) if platform.machine() == "x86_64" else (220, 435, 220)

def raw(number, *arguments):
    parent = os.getpid()
    result = libc.syscall(ctypes.c_long(number), *(ctypes.c_long(a) for a in arguments))
    if result < 0:
        raise OSError(ctypes.get_errno(), "syscall")
    if os.getpid() != parent:
        os._exit(0)
    return result

attempt("clone as fork does", raw, CLONE, 17, 0, 0, 0, 0)
for flag in (0x10000000, 0x20000000, 0x20000, 0x40000000, 0x8000):
    attempt(f"clone {flag:#x}", raw, CLONE, flag | 17, 0, 0, 0, 0)
attempt("thread with a namespace", raw, CLONE, 0x10f00 | 0x40000000, 0, 0, 0, 0)
attempt("high bits beside the flags", raw, CLONE, (1 << 32) | 17, 0, 0, 0, 0)
attempt("clone3", raw, CLONE3, 0, 0)
attempt("vfork", raw, VFORK, 17, 0, 0, 0, 0)
