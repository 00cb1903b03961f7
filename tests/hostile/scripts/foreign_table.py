"""Attack: a system call of the 32-bit table, where the numbers mean other calls.

Expected: forbidden SIGSYS
"""

import ctypes
import mmap
import platform

if platform.machine() != "x86_64":
    import os, signal
    os.kill(os.getpid(), signal.SIGSYS)
code = mmap.mmap(-1, 4096, prot=mmap.PROT_READ | mmap.PROT_WRITE | mmap.PROT_EXEC)
code.write(b"\xb8\x14\x00\x00\x00\xcd\x80\xc3")  # mov eax, 20; int 0x80; ret
ctypes.CFUNCTYPE(ctypes.c_int)(ctypes.addressof(ctypes.c_char.from_buffer(code)))()
