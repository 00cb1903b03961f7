"""A look at a file before it is accepted: does Python take it? Compiled in a confined process, never run.

Source text can attack a compiler (deep nesting, codecs, giant lines), so even this happens in the jail.
"""

import queue
import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Final

from grader.contracts.errors import InfrastructureError, ProtocolError
from grader.contracts.grading import SyntaxProblem
from grader.contracts.limits import Limits
from grader.sandbox import Sandbox, Verdict
from grader.sim.frames import SYNTAX_ERROR, Exit
from grader.sim.wire import PROTOCOL, decode, encode_start

_LIMITS: Final = Limits(cpu_s=2.0, wall_s=20.0)
_SHOWN_INDENT: Final = 4
_TOO_MUCH: Final = "this file is too much for the Python compiler (nested too deeply, or too large)"


class SandboxPreflight:
    """Implements `grader.contracts.grading.Preflight`; thread-safe."""

    def __init__(self, *sandboxes: Sandbox) -> None:
        """Take over sandboxes of `grader.bootstrap.build_syntax_sandbox`: as many checks go on at once."""
        self._idle: queue.LifoQueue[Sandbox] = queue.LifoQueue()
        for sandbox in sandboxes:
            self._idle.put(sandbox)

    def check(self, source: bytes, file_name: str) -> SyntaxProblem | None:
        """Compile `source` in a confined process; return what is wrong with it, or None.

        Raises:
            InfrastructureError, SandboxError: the check itself could not be done.
        """
        with self._borrowed() as sandbox, sandbox.open(_LIMITS) as jail:
            jail.send(encode_start({"protocol": PROTOCOL, "file_name": file_name}, source))
            ending = _last_frame(jail.receive)
            report = jail.close()
        if ending is None:
            if report.verdict is Verdict.INFRASTRUCTURE:
                raise InfrastructureError(f"the syntax check failed: {report.detail}")
            return SyntaxProblem(message=_TOO_MUCH, line=None)
        if ending.reason != SYNTAX_ERROR:
            return None
        line = _line_of(source, ending.line)
        return SyntaxProblem(
            message=f"{ending.exception_type}: {ending.message}",
            line=ending.line or None,
            column=_column(ending.detail, line),
            text=line,
        )

    @contextmanager
    def _borrowed(self) -> Iterator[Sandbox]:
        sandbox = self._idle.get()
        try:
            yield sandbox
        finally:
            self._idle.put(sandbox)


def _line_of(source: bytes, number: int) -> str:
    lines = re.split(r"\r\n|\r|\n", source.decode("utf-8-sig", "replace"))
    return lines[number - 1] if 1 <= number <= len(lines) else ""


def _column(message: str, line: str) -> int | None:
    """Return the 1-based column that the caret in Python's own `message` points at, or None.

    Python prints the line without its indentation, four spaces in, and the caret below.
    """
    carets = [shown for shown in message.splitlines() if "^" in shown and not shown.strip(" ^")]
    if not carets:
        return None
    column = carets[-1].index("^") - _SHOWN_INDENT + len(line) - len(line.lstrip()) + 1
    return column if 1 <= column <= len(line) + 1 else None


def _last_frame(receive: Any) -> Exit | None:
    ending = None
    try:
        while (body := receive()) is not None:
            frame = decode(body)
            if isinstance(frame, Exit):
                ending = frame
    except ProtocolError:
        return None
    return ending
