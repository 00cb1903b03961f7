"""Attack: raise or remove its own limits.

Expected: finished
"""

import os
import resource

for name in ("AS", "DATA", "CPU", "FSIZE", "NOFILE", "CORE", "NPROC", "STACK", "MEMLOCK"):
    number = getattr(resource, f"RLIMIT_{name}")
    attempt(f"no limit on {name}", resource.setrlimit, number, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
    attempt(f"set the limit on {name}", resource.setrlimit, number, (1 << 30, 1 << 30))
attempt("nice", os.nice, -5)
attempt("real-time priority", os.sched_setscheduler, 0, os.SCHED_FIFO, os.sched_param(1))
