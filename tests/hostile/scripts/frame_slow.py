"""Attack: send a frame byte by byte, for ever.

Expected: cpu_limit or protocol
"""

import os

body = (60000).to_bytes(4, "little") + b"x" * 60000
while True:
    for n in range(len(body)):
        os.write(channel, body[n : n + 1])
