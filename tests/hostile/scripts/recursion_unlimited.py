"""Attack: recurse without end after lifting the interpreter's own limit.

Expected: cpu_limit or finished
"""

import sys

sys.setrecursionlimit(10**9)


def f():
    f()


attempt("recurse", f)
