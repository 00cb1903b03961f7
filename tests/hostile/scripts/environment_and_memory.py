"""Attack: look for secrets in the environment and in the memory inherited from the parent.

Expected: finished
"""

import ctypes
import gc
import os

canary = "canary-in-" + "the-environment"
print("BREACH" if canary in str(dict(os.environ)) else "held: environment")
found = [o for o in gc.get_objects() if isinstance(o, (str, bytes, dict)) and "canary-in-the-env" + "ironment" in str(o)[:10**5]]
found = [o for o in found if o is not globals() and "attempt" not in o]
print("BREACH" if found else "held: objects")
environ = ctypes.POINTER(ctypes.c_char_p).in_dll(ctypes.CDLL(None), "environ")
block = b""
position = 0
while environ[position] is not None:
    block += environ[position]
    position += 1
print("BREACH" if canary.encode() in block else "held: environment block")
