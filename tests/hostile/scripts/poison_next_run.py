"""Attack: change everything in the interpreter that a later run could see.

Expected: finished
"""

import builtins
import os
import sys

sys.modules["json"] = None
sys.path.insert(0, "/tmp")
builtins.print = lambda *a, **k: None
os.environ["EVIL"] = "1"
os.umask = None
sys.meta_path.clear()
object.__repr__
import ctypes
ctypes.CDLL(None).setenv(b"EVIL", b"1", 1)
sys.stdout.write("held: in this process only\n")
