"""Run a command as nobody in particular who is root in a user namespace of their own.

So no part of a build has rights on this host. An ordinary user is mapped by ``buildah unshare``; root steps
down to ids that belong to nobody: ``python unprivileged.py COMMAND ...``. Standard library only.
"""

import ctypes
import os
import sys
from pathlib import Path
from typing import Final

FIRST_ID: Final = 100_000
IDS: Final = 65_536
_CLONE_NEWNS, _CLONE_NEWUSER = 0x0002_0000, 0x1000_0000


def command(*arguments: str) -> list[str]:
    """Return the command that runs `arguments` so."""
    if os.geteuid() == 0:
        return [sys.executable, __file__, *arguments]
    return ["buildah", "unshare", *arguments]


def give(folder: Path) -> None:
    """Let `command`'s user own `folder`."""
    if os.geteuid() == 0:
        os.chown(folder, FIRST_ID, FIRST_ID)


def _main(arguments: list[str]) -> int:
    ready_read, ready_write = os.pipe()
    mapped_read, mapped_write = os.pipe()
    child = os.fork()
    if child == 0:
        _become_mapped(ready_write, mapped_read, mapped_write)
        os.execvp(arguments[0], arguments)  # noqa: S606  (that is the point)
    os.close(ready_write)
    if not os.read(ready_read, 1):
        os.waitpid(child, 0)
        return 1
    for kind in ("uid_map", "gid_map"):
        Path(f"/proc/{child}/{kind}").write_text(f"0 {FIRST_ID} {IDS}\n", encoding="ascii")
    os.write(mapped_write, b"+")
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def _become_mapped(ready_write: int, mapped_read: int, mapped_write: int) -> None:
    os.close(mapped_write)
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.unshare(_CLONE_NEWUSER | _CLONE_NEWNS):
        raise OSError(ctypes.get_errno(), "no user namespace to be had")
    os.write(ready_write, b"+")
    os.read(mapped_read, 1)
    os.setgroups([])
    os.setresgid(0, 0, 0)
    os.setresuid(0, 0, 0)


if __name__ == "__main__":
    sys.exit(_main(sys.argv[1:]))
