"""Attack: start threads without end.

Expected: finished or forbidden
"""

import threading
import _thread

lock = threading.Lock()
lock.acquire()

def start():
    while True:
        _thread.start_new_thread(lock.acquire, ())

attempt("threads", start)
