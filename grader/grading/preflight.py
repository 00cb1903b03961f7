"""A look at a file before it is accepted: does Python take it? Compiled in a confined process, never run.

Source text can attack a compiler (deep nesting, codecs, giant lines), so even this happens in the jail. A student
waits for the answer, so the process is forked and confined before the file comes, and ended after the answer.
"""

import queue
import re
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from typing import Final

from grader.contracts.assignment import Limits
from grader.contracts.errors import GraderError, InfrastructureError, ProtocolError
from grader.contracts.grading import SyntaxProblem
from grader.contracts.python import Self
from grader.contracts.upload import decoded
from grader.sandbox import Jail, RunEnd, Sandbox
from grader.sim.frames import SYNTAX_ERROR, Exit
from grader.sim.wire import PROTOCOL, decode, encode_start

_LIMITS: Final = Limits(cpu_s=2.0, wall_s=20.0)
PATIENCE_S: Final = 60.0  # more than a check, and preparing the next process, may take
_SHOWN_INDENT: Final = 4
_TOO_MUCH: Final = "this file is too much for the Python compiler (nested too deeply, or too large)"


def _ignored(_busy_s: float) -> None:
    pass


class NoPreflight:
    """Accepts every text: its syntax is then checked where it is graded, and reported as ``syntax_error``."""

    def check(
        self,
        source: bytes,
        file_name: str,
        busy: Callable[[float], None] = _ignored,
        *,
        patience_s: float = PATIENCE_S,
    ) -> SyntaxProblem | None:
        """Return None."""
        return None


class SandboxPreflight:
    """Implements `grader.contracts.grading.Preflight`; thread-safe. Use as a context manager, or call `close`."""

    def __init__(self, *sandboxes: Sandbox) -> None:
        """Take over sandboxes of `grader.sandbox.syntax_sandbox`: as many checks go on at once."""
        self._idle: queue.SimpleQueue[Sandbox] = queue.SimpleQueue()
        self._behind = ThreadPoolExecutor(1, thread_name_prefix="grader-preflight")
        self._closed = False
        for sandbox in sandboxes:
            self._behind.submit(self._make_ready, sandbox)

    def check(
        self,
        source: bytes,
        file_name: str,
        busy: Callable[[float], None] = _ignored,
        *,
        patience_s: float = PATIENCE_S,
    ) -> SyntaxProblem | None:
        """Compile `source` in a confined process; return what is wrong with it, or None.

        `busy` is told for how many seconds the process was busy with it, without what the check had to wait, at
        most `patience_s`.

        Raises:
            InfrastructureError, SandboxError: the check itself could not be done.
        """
        sandbox = self._free(patience_s)
        jail: Jail | None = None
        begun_s = time.monotonic()
        try:
            jail = sandbox.open(_LIMITS)
            jail.send(encode_start({"protocol": PROTOCOL, "file_name": file_name}, source))
            ending = _ending(jail.receive)
            report = jail.close() if ending is None else None
        finally:
            self._put_away(sandbox, jail)
        if report is not None and report.end is RunEnd.INFRASTRUCTURE:
            raise InfrastructureError(f"the syntax check failed: {report.detail}")
        busy(time.monotonic() - begun_s)
        if ending is None:
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

    def _free(self, patience_s: float) -> Sandbox:
        try:
            return self._idle.get(timeout=patience_s)
        except queue.Empty:
            raise InfrastructureError(f"no syntax check was free for {patience_s:.0f} s") from None

    def close(self) -> None:
        """Prepare no more processes, and return when those being prepared or ended are done.

        Checks that are still under way go on, as long as the owner of the sandboxes keeps them open.
        """
        self._closed = True
        self._behind.shutdown()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _put_away(self, sandbox: Sandbox, used: Jail | None) -> None:
        try:
            self._behind.submit(self._make_ready, sandbox, used)
        except RuntimeError:  # closed meanwhile
            self._make_ready(sandbox, used)

    def _make_ready(self, sandbox: Sandbox, used: Jail | None = None) -> None:
        """End the process of the last check and, unless closed, have one ready for the next."""
        try:
            with suppress(GraderError):  # the next check meets the fault again, and can report it
                if used is not None:
                    used.close()
                if not self._closed:
                    sandbox.prepare(_LIMITS)
        finally:
            self._idle.put(sandbox)


def _line_of(source: bytes, number: int) -> str:
    lines = re.split(r"\r\n|\r|\n", decoded(source))
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


def _ending(receive: Callable[[], bytes | None]) -> Exit | None:
    """Return how the compiler said that it ended; nothing it might send after that counts."""
    try:
        while (body := receive()) is not None:
            frame = decode(body)
            if isinstance(frame, Exit):
                return frame
    except ProtocolError:
        return None
    return None
