"""Attack: take every thread that the host has left, below Python, and hold them.

Expected: finished or forbidden
"""

import ctypes

libc = ctypes.CDLL(None)
attributes = ctypes.create_string_buffer(128)
libc.pthread_attr_init(attributes)
libc.pthread_attr_setstacksize(attributes, ctypes.c_size_t(16384))
pause = ctypes.cast(libc.pause, ctypes.c_void_p)
thread = ctypes.c_ulong()
count = 0
while count < 20_000 and libc.pthread_create(ctypes.byref(thread), attributes, pause, None) == 0:
    count += 1
if count > 64:
    libc.usleep(500_000)  # where the kernel does not count, the grader does, a moment later
print("held" if count <= 64 else "BREACH", count)
