"""Attack: write to stderr without end, byte by byte and in large blocks.

Expected: output_limit
"""

import os

while True:
    os.write(2, b'y')
    os.write(2, b'z' * 65536)
