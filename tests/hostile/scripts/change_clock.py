"""Attack: set the system's clock.

Expected: finished
"""

import time

attempt("set the clock", time.clock_settime, time.CLOCK_REALTIME, 0)
