"""Attack: keep data in the buffers of pipes.

Expected: finished
"""

import os

def fill():
    while True:
        os.pipe()

attempt("pipes", fill)
import fcntl
attempt("larger pipes", fcntl.fcntl, 1, 1031, 1 << 20)
