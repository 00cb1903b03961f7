"""Attack: abort the interpreter.

Expected: crashed SIGABRT
"""

import os

os.abort()
