"""Attack: send half a frame and wait.

Expected: stalled
"""

import os

os.write(channel, (100).to_bytes(4, 'little') + b'x' * 50)
os.read(os.pipe()[0], 1)
