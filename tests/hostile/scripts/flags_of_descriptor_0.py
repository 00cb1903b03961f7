"""Attack: leave flags on the descriptor that the next run begins with.

Expected: finished
"""

import fcntl
import os

LASTING = os.O_NONBLOCK | os.O_APPEND
flags = fcntl.fcntl(0, fcntl.F_GETFL)
fcntl.fcntl(0, fcntl.F_SETFL, flags | LASTING)
print("BREACH" if flags & LASTING else "held")
