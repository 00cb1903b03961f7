"""Attack: keep data in anonymous files, which no memory limit counts.

Expected: finished
"""

import os

attempt('memfd', os.memfd_create, 'evil')
