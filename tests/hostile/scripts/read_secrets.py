"""Attack: read files that hold secrets: accounts, keys, other programs, the grader, the solutions.

Expected: finished
"""

import glob
import os
import sys

grader = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(sys.path[0]))))
for path in ("/etc/passwd", "/etc/shadow", "/etc/hostname", "/etc/machine-id", "/root/.ssh/id_rsa", "/root/.bashrc",
             "/proc/self/environ", "/proc/1/environ", f"/proc/{os.getppid()}/environ", "/proc/self/mem",
             "/proc/self/maps", "/proc/self/cmdline", "/proc/mounts", "/proc/net/tcp", "/sys/kernel/notes",
             "/dev/mem", "/dev/kmsg", "/dev/sda", "/dev/tty", "/dev/ptmx",
             f"{grader}/pyproject.toml", f"{grader}/grader/sandbox.py", f"{grader}/grader/jail/syscalls.py",
             f"{grader}/assignments/square/solution.py", f"{grader}/.git/config", sys.executable or "/bin/sh"):
    attempt(path, open, path, "rb")
for place in ("/", "/etc", "/root", "/home", "/proc", "/proc/self/fd", "/tmp", "/var/lib", grader, f"{grader}/assignments",
              os.path.dirname(os.__file__), os.path.dirname(os.__file__) + "/site-packages"):
    attempt(f"list {place}", os.listdir, place)
try:
    import numpy
except ImportError:
    pass
else:
    site = os.path.dirname(os.path.dirname(numpy.__file__))
    attempt("list site-packages", os.listdir, site)
    attempt("read pydantic", open, site + "/pydantic/__init__.py")
print("held: found", glob.glob("/*"))
