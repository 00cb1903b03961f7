"""Tells the student which call the sandbox is going to refuse. The refusal itself is the sandbox's."""

import os
import sys
from typing import Any

from rclpy._link import link

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
        "shutil.rmtree",
        "shutil.copyfile",
        "shutil.move",
    }
)
_WRITING = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
_noted: set[str] = set()


def watch() -> None:
    """Note the first use of each call in `FORBIDDEN`, and of `open` for writing."""
    sys.addaudithook(_on_event)


def _on_event(event: str, args: tuple[Any, ...]) -> None:
    if event == "open":
        if isinstance(args[0], int) or not (isinstance(args[2], int) and args[2] & _WRITING):
            return
        if args[0] != os.devnull:
            _note("open for writing", str(args[0]))
    elif event in FORBIDDEN:
        _note(event, str(args[0]) if args else "")


def _note(call: str, target: str) -> None:
    if call not in _noted:
        _noted.add(call)
        link.note("forbidden", f"{call}: {target}" if target else call)
