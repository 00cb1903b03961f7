"""Attack: close the channel and keep the output pipes open for ever.

Expected: stalled
"""

import os

os.close(channel)
os.read(os.pipe()[0], 1)
