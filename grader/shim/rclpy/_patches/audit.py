"""Refuses calls that the sandbox would refuse as well, with an exception that is the same on every host.

This is no security boundary: a script that gets round this module is stopped by the sandbox. But which error the
kernel gives depends on the host's layers (`EACCES`, `EPERM`, `EROFS`, a missing file), and a report must not.
"""

from __future__ import annotations

import errno
import os
import sys

from rclpy._link import link

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

FORBIDDEN = frozenset(
    {
        "os.fork",
        "os.forkpty",
        "os.system",
        "os.exec",
        "os.posix_spawn",
        "os.spawn",
        "os.kill",
        "os.remove",
        "os.rename",
        "os.rmdir",
        "os.mkdir",
        "os.chmod",
        "os.chown",
        "os.link",
        "os.symlink",
        "os.truncate",
        "subprocess.Popen",
        "socket.connect",
        "socket.bind",
        "socket.sendto",
        "socket.getaddrinfo",
        "socket.gethostbyname",
    }
)
"""Audit events of these calls. Those that `files` carries out in the script's own home raise none."""
_WRITING = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
_noted: set[str] = set()


def watch() -> None:
    """Refuse each call in `FORBIDDEN`, and `open` for writing; note the first use of each."""
    sys.addaudithook(_on_event)


def _on_event(event: str, args: tuple[Any, ...]) -> None:
    if event == "open":
        if isinstance(args[0], int) or not (isinstance(args[2], int) and args[2] & _WRITING):
            return
        if args[0] != os.devnull:
            _note("open for writing", _text(args[0]))
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), args[0])
    elif event in FORBIDDEN:
        target = args[0] if args else None
        _note(event, _text(target))
        named = (_text(target),) if isinstance(target, (str, bytes)) else ()
        raise PermissionError(errno.EPERM, os.strerror(errno.EPERM), *named)


def _text(target: object) -> str:
    return os.fsdecode(target) if isinstance(target, bytes) else "" if target is None else str(target)


def _note(call: str, target: str) -> None:
    if call not in _noted:
        _noted.add(call)
        link.note("forbidden", f"{call}: {target}" if target else call)
