"""Attack: fill stdout and stderr from two threads while burning CPU.

Expected: output_limit
"""

import os
import threading

def flood(fd):
    while True:
        os.write(fd, b"x" * 65536)

threading.Thread(target=flood, args=(1,)).start()
flood(2)
