"""Attack: use a descriptor that was left open.

Expected: finished
"""

import os

for fd in range(4, 1024):
    try:
        os.fstat(fd)
    except OSError:
        continue
    print("BREACH: descriptor", fd)
print("held: only four descriptors")
print("held" if os.read(0, 1) == b"" else "BREACH: stdin")
