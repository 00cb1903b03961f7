"""Attack: a lock that is never released.

Expected: stalled
"""

import threading

lock = threading.Lock()
lock.acquire()
lock.acquire()
