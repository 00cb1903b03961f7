"""Attack: wait for the end of a thread as for a child of vfork, which the kernel shows as waiting for a disk.

Expected: finished
"""

import ctypes

CLONE_VM, CLONE_FS, CLONE_FILES, CLONE_SIGHAND, CLONE_VFORK = 0x100, 0x200, 0x400, 0x800, 0x4000
CLONE_THREAD, CLONE_SYSVSEM = 0x10000, 0x40000
STACK_BYTES = 65_536
libc = ctypes.CDLL(None, use_errno=True)
stack = ctypes.create_string_buffer(STACK_BYTES)
top = ctypes.c_void_p((ctypes.addressof(stack) + STACK_BYTES - 64) & ~15)
flags = CLONE_VM | CLONE_FS | CLONE_FILES | CLONE_SIGHAND | CLONE_THREAD | CLONE_SYSVSEM | CLONE_VFORK
started = libc.clone(ctypes.cast(libc.pause, ctypes.c_void_p), top, flags, None)
print("held" if started < 0 else "BREACH: a thread was started so", ctypes.get_errno(), flush=True)
