"""Attack: send a frame one byte longer than allowed.

Expected: protocol
"""

import os

os.write(channel, (65537).to_bytes(4, 'little') + b'x' * 65537)
