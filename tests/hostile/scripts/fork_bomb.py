"""Attack: fork without end.

Expected: finished
"""

import os

attempt('fork', os.fork)
attempt('vfork or forkpty', os.forkpty)
attempt('posix_spawn', os.posix_spawn, '/bin/true', ['true'], {})
