"""Attack: ignore every signal, then burn CPU.

Expected: cpu_limit
"""

import signal

for number in signal.valid_signals():
    try:
        signal.signal(number, signal.SIG_IGN)
    except (OSError, ValueError):
        pass
while True:
    pass
