"""Attack: recurse without end.

Expected: finished
"""

def f():
    f()

attempt("recurse", f)
