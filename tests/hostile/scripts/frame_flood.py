"""Attack: send frames without end.

Expected: protocol
"""

import os

data = (1).to_bytes(4, 'little') * 1 + b'x'
while True:
    os.write(channel, data * 10000)
