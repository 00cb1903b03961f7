"""Attack: close the channel and exit as if all were well.

Expected: finished
"""

import os

os.close(3)
