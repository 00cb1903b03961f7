"""Attack: send half a frame and exit.

Expected: protocol
"""

import os

os.write(channel, (100).to_bytes(4, 'little') + b'x' * 50)
os._exit(0)
