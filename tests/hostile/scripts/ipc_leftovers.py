"""Attack: leave shared memory, semaphores and queues behind.

Expected: finished
"""

from multiprocessing import shared_memory

attempt("posix shared memory", shared_memory.SharedMemory, "evil", True, 4096)
import ctypes
libc = ctypes.CDLL(None, use_errno=True)
for name, arguments in {"shmget": (0x1234, 4096, 0o1666), "semget": (0x1234, 1, 0o1666), "msgget": (0x1234, 0o1666)}.items():
    print("held:" if getattr(libc, name)(*arguments) < 0 else "BREACH:", name)
print("held:" if libc.sem_open(b"/evil", 0o100, 0o666, 1) == 0 else "BREACH:", "sem_open")
