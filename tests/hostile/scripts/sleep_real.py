"""Attack: sleep in real time through the C library, for ever.

Expected: stalled
"""

import ctypes

ctypes.CDLL(None).sleep(100000)
