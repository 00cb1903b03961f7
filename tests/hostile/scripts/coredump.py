"""Attack: leave a core file, or the interpreter's crash report.

Expected: crashed SIGQUIT
"""

import os
import signal

signal.signal(signal.SIGQUIT, signal.SIG_DFL)
os.kill(os.getpid(), signal.SIGQUIT)
