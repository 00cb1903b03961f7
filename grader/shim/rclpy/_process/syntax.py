"""What a confined process executes that only says whether a script is Python: read START, compile, send EXIT.

A service asks this of every upload, so nothing is prepared here that only a running script needs.
"""

from __future__ import annotations

import json
import os

from rclpy import _wire
from rclpy._link import Descriptor, link
from rclpy._patches import tracebacks

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import NoReturn


def run(channel: int = 3) -> NoReturn:
    """Compile the script that START brings over descriptor `channel`, tell how it went, and end."""
    text, source = link.receive_start(Descriptor(channel))
    tracebacks.script.file_name = json.loads(text)["file_name"]
    tracebacks.script.source = source
    link.exit(_ending(source, tracebacks.script.file_name))
    os._exit(0)


def _ending(source: bytes, file_name: str) -> _wire.Exit:
    try:
        compile(source, file_name, "exec", dont_inherit=True)
    except BaseException as error:
        kind, message, line = type(error).__name__, tracebacks.message_of(error), tracebacks.line_of(error)
        text = tracebacks.format_exception(error)
        return _wire.Exit(0, _wire.BAD_SYNTAX, False, 1, kind, message, line, text)
    return _wire.Exit(0, _wire.FINISHED, False, 0)
