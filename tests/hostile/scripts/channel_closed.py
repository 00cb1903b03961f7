"""Attack: close the channel and go on for ever.

Expected: cpu_limit
"""

import os

os.close(channel)
while True:
    pass
