"""The weakest possible shim: runs the script it is sent in an unpatched interpreter.

What stands between a script and the host is then the jail alone. Standard library only.
"""

import errno
import os
import sys
import traceback
from collections.abc import Callable


def _read(channel: int, size: int) -> bytes:
    data = b""
    while len(data) < size:
        part = os.read(channel, size - len(data))
        if not part:
            raise EOFError
        data += part
    return data


def attempt(what: str, call: Callable[..., object], *arguments: object) -> object:
    """Try `call` and print ``BREACH`` when it succeeds, ``held`` when it is refused."""
    try:
        result = call(*arguments)
    except (OSError, MemoryError, ValueError, RuntimeError) as error:
        reason = errno.errorcode.get(getattr(error, "errno", 0) or 0, type(error).__name__)
        print(f"held: {what}: {reason}")
        return None
    print(f"BREACH: {what}: {result!r}")
    return result


def run(channel: int) -> int:
    source = _read(channel, int.from_bytes(_read(channel, 4), "little"))

    def frame(body: bytes) -> None:
        os.write(channel, len(body).to_bytes(4, "little") + body)

    names = {"__name__": "__main__", "attempt": attempt, "frame": frame, "channel": channel}
    code = 0
    try:
        exec(compile(source, "student.py", "exec"), names)
    except SystemExit as error:
        code = error.code if isinstance(error.code, int) else 1
    except BaseException as error:
        traceback.print_exc()
        frame(b"raised " + type(error).__name__.encode())
        code = 1
    sys.stdout.flush()
    frame(b"end")
    return code
