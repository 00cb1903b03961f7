"""Attack: fill the pipe exactly, then wait for ever.

Expected: stalled
"""

import os

os.write(1, b'x' * 65536)
os.read(os.pipe()[0], 1)
