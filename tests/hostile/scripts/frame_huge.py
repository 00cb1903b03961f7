"""Attack: announce a frame of 4 GiB.

Expected: protocol
"""

import os

os.write(channel, b'\xff\xff\xff\xff' + b'x' * 1000)
while True:
    pass
