"""Attack: change user, group, capabilities, or undo the confinement.

Expected: finished
"""

import ctypes
import os

libc = ctypes.CDLL(None, use_errno=True)

def call(name, *arguments):
    result = getattr(libc, name)(*(ctypes.c_long(a) for a in arguments))
    if result < 0:
        raise OSError(ctypes.get_errno(), name)
    return result

attempt("setuid", os.setuid, 0)
attempt("setresuid", os.setresuid, 0, 0, 0)
attempt("setgid", os.setgid, 0)
attempt("setgroups", os.setgroups, [0])
attempt("dumpable", call, "prctl", 4, 1, 0, 0, 0)
attempt("keep capabilities", call, "prctl", 8, 1, 0, 0, 0)
attempt("death signal", call, "prctl", 1, 0, 0, 0, 0)
attempt("personality", call, "personality", 0x0400000)
attempt("namespaces", call, "unshare", 0x10000000)
attempt("another namespace", call, "setns", 1, 0)
attempt("mount", call, "mount", 0, 0, 0, 0, 0)
attempt("umount", call, "umount2", 0, 0)
print("held" if os.getuid() != 0 else "BREACH: root")
