"""Attack: read address 0.

Expected: crashed SIGSEGV
"""

import ctypes

ctypes.string_at(0)
