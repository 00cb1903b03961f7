"""Attack: patch the functions that report the result.

Expected: finished
"""

import os
import sys

real = os.write
caller = sys._getframe(1)
caller.f_globals["traceback"] = None
os.write = lambda fd, data: len(data)
caller.f_locals["frame"](b"score 100")
os.write = real
print("held: the frames decide nothing by themselves")
