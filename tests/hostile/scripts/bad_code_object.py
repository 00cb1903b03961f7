"""Attack: crash the interpreter with a nonsensical code object.

Expected: crashed SIGSEGV
"""

import ctypes

ctypes.memset(id(print), 0xFF, 64)
print()
