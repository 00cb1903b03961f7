"""Attack: change owner, mode, times and attributes of files that can be seen.

Expected: finished
"""

import os
import sys

for path in (os.__file__, sys.path[0], "/", "/tmp", "/dev/null"):
    attempt(f"chmod {path}", os.chmod, path, 0o777)
    attempt(f"chown {path}", os.chown, path, os.getuid(), os.getgid())
    attempt(f"utime {path}", os.utime, path, (0, 0))
    attempt(f"xattr {path}", os.setxattr, path, "user.evil", b"1")
attempt("chmod of stdout", os.fchmod, 1, 0o777)
attempt("chroot", os.chroot, "/")
attempt("lock", __import__("fcntl").flock, 1, 2)
attempt("record lock", __import__("fcntl").lockf, 1, 2)
