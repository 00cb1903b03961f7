"""Attack: an exit hook that never returns.

Expected: finished
"""

import atexit
import threading

atexit.register(lambda: threading.Event().wait())
threading.Thread(target=threading.Event().wait).start()
print("held: exit hooks are not run")
