"""Attack: burn CPU in many threads at once; their time adds up.

Expected: cpu_limit
"""

import threading

def burn():
    while True:
        sum(range(1000))

for _ in range(8):
    threading.Thread(target=burn).start()
burn()
