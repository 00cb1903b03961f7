"""Attack: wait in calls that use no CPU time and look as if the host were slow.

Expected: finished
"""

import ctypes
import mmap
import os

libc = ctypes.CDLL(None, use_errno=True)
O_DIRECT = {"x86_64": 0o40000, "aarch64": 0o200000}[os.uname().machine]
MEMBARRIER = {"x86_64": 324, "aarch64": 283}[os.uname().machine]
library = libc.open(ctypes.__file__.encode(), 0)
page = mmap.mmap(-1, mmap.PAGESIZE)
address = ctypes.addressof(ctypes.c_char.from_buffer(page))
PAGEOUT = 21
calls = {
    "membarrier": lambda: libc.syscall(MEMBARRIER, 1, 0, 0),
    "fsync": lambda: libc.fsync(library),
    "disk": lambda: libc.open(ctypes.__file__.encode(), O_DIRECT),
    "disk later": lambda: libc.fcntl(library, 4, O_DIRECT),
    "pageout": lambda: libc.madvise(ctypes.c_void_p(address), mmap.PAGESIZE, PAGEOUT),
}
for name, call in calls.items():
    print("held" if call() < 0 else "BREACH", name)
