"""Attack: read from a pipe that nobody writes to.

Expected: stalled
"""

import os

reading, writing = os.pipe()
os.read(reading, 1)
