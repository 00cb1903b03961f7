"""Attack: stop itself with SIGSTOP, so that it never ends.

Expected: finished
"""

import os
import signal

attempt("stop", os.kill, os.getpid(), signal.SIGSTOP)
attempt("stop a thread", signal.pthread_kill, __import__("threading").get_ident(), signal.SIGSTOP)
attempt("kill, to look like a fault of the host", os.kill, os.getpid(), signal.SIGKILL)
