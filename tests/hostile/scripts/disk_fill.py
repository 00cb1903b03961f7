"""Attack: fill the disk with a big, a sparse and many small files.

Expected: finished
"""

import os

def big():
    with open("/tmp/evil_big", "wb") as file:
        file.write(b"x" * (64 << 20))

def sparse():
    with open("/tmp/evil_sparse", "wb") as file:
        file.truncate(1 << 40)

def many():
    for n in range(10000):
        open(f"/tmp/evil_{n}", "w").close()

attempt("big file", big)
attempt("sparse file", sparse)
attempt("many files", many)
attempt("unlinked file", os.open, "/tmp", os.O_TMPFILE | os.O_RDWR)
