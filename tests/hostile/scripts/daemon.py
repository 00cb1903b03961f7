"""Attack: leave the session and live on in the background.

Expected: finished
"""

import os

attempt("fork into the background", os.fork)
attempt("new session", os.setsid)
print("held: still one process")
