"""Attack: write, create, rename and remove files wherever they might be writable.

Expected: finished
"""

import os
import sys
import tempfile

for place in ("/tmp", "/var/tmp", "/dev/shm", "/run", "/run/lock", "/home", "/root", "/", ".", sys.path[0],
              os.path.dirname(os.__file__), "/proc/self", "/dev/mqueue"):
    attempt(f"create in {place}", open, f"{place}/evil", "w")
    attempt(f"directory in {place}", os.mkdir, f"{place}/evil_directory")
    attempt(f"link in {place}", os.symlink, "/etc/passwd", f"{place}/evil_link")
    attempt(f"fifo in {place}", os.mkfifo, f"{place}/evil_fifo")
    attempt(f"hard link in {place}", os.link, os.__file__, f"{place}/evil_hard_link")
    attempt(f"device in {place}", os.mknod, f"{place}/evil_device", 0o20666, os.makedev(1, 1))
attempt("temporary file", tempfile.TemporaryFile)
attempt("overwrite the library", open, os.__file__, "r+")
attempt("truncate the library", os.truncate, os.__file__, 0)
attempt("remove the library", os.remove, os.__file__)
attempt("rename the library", os.rename, os.__file__, "/tmp/evil")
