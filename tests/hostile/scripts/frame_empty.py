"""Attack: send a frame without a body.

Expected: protocol
"""

import os

os.write(channel, bytes(4))
os.read(os.pipe()[0], 1)
