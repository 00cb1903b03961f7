"""Attack: allocate with numpy.

Expected: finished
"""

try:
    import numpy
except ImportError:
    print("held: no numpy here")
else:
    attempt("numpy", numpy.ones, 1 << 36)
