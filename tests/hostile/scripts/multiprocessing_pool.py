"""Attack: use a pool of processes.

Expected: finished
"""

import multiprocessing

attempt("process", multiprocessing.Process(target=print).start)
attempt("pool", multiprocessing.Pool, 4)
