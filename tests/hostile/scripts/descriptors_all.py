"""Attack: use up all descriptors.

Expected: finished
"""

import os

def fill():
    while True:
        os.dup(1)

attempt("dup", fill)
