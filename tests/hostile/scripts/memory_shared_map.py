"""Attack: map shared anonymous memory, which the data limit does not count.

Expected: finished
"""

import mmap

def fill():
    for _ in range(64):
        area = mmap.mmap(-1, 64 << 20)
        for offset in range(0, 64 << 20, 1 << 20):
            area[offset] = 1
        kept.append(area)

kept = []
attempt("shared maps", fill)
