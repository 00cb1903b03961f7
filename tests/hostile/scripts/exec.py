"""Attack: replace itself by another program.

Expected: finished
"""

import os
import subprocess
import sys

attempt("exec a shell", os.execv, "/bin/sh", ["sh", "-c", "echo BREACH"])
attempt("exec the interpreter", os.execv, sys.executable or "/usr/bin/python3", ["python3"])
attempt("subprocess", subprocess.run, ["/bin/true"])
attempt("execveat of a descriptor", os.execve, 0, ["x"], {})
