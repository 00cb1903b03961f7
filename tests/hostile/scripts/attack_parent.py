"""Attack: signal, trace, limit, slow down or read the parent and every other process.

Expected: finished
"""

import ctypes
import os
import resource
import signal

libc = ctypes.CDLL(None, use_errno=True)

def call(name, *arguments):
    result = getattr(libc, name)(*(ctypes.c_long(a) for a in arguments))
    if result < 0:
        raise OSError(ctypes.get_errno(), name)
    return result

for pid in (os.getppid(), 1, os.getppid() - 1, -1, 0, 2):
    attempt(f"kill {pid}", os.kill, pid, 0)
    attempt(f"terminate {pid}", os.kill, pid, signal.SIGTERM)
    attempt(f"limit {pid}", resource.prlimit, pid or 1, resource.RLIMIT_CPU, (1, 1))
    attempt(f"look at the limits of {pid}", resource.prlimit, pid or 1, resource.RLIMIT_CPU)
    attempt(f"trace {pid}", call, "ptrace", 16, pid, 0, 0)
    attempt(f"read memory of {pid}", call, "process_vm_readv", pid, 0, 0, 0, 0, 0)
    attempt(f"write memory of {pid}", call, "process_vm_writev", pid, 0, 0, 0, 0, 0)
    attempt(f"priority of {pid}", os.setpriority, os.PRIO_PROCESS, pid, 19)
    attempt(f"affinity of {pid}", os.sched_setaffinity, pid, {0})
    attempt(f"pidfd of {pid}", os.pidfd_open, pid or 1)
    attempt(f"group of {pid}", os.setpgid, pid, 0)
attempt("kill a group", os.killpg, os.getpgid(0), 0)
attempt("let itself be traced", call, "ptrace", 0, 0, 0, 0)
