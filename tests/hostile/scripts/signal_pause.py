"""Attack: wait for a signal that nobody sends.

Expected: stalled
"""

import signal

signal.pause()
