"""What the script said: its log records and the notes about it, bounded."""

import re
from typing import Final

from grader.contracts.errors import ProtocolError
from grader.contracts.outcome import LOG_LEVELS, LogRecord, Note
from grader.sim.cdr import decode

LOG: Final = "rcl_interfaces/msg/Log"
MAX_LOGS: Final = 2_000
MAX_NOTES: Final = 100
MAX_TEXT: Final = 1_000  # characters kept of one message
MAX_LOG_TEXT: Final = 500_000  # characters of all records, names included: each is stored with the report

_CODE: Final = re.compile(r"[a-z][a-z0-9_]{0,63}")


class Journal:
    """Collects log records and notes; what does not fit is counted or left out."""

    def __init__(self) -> None:
        self._logs: list[LogRecord] = []
        self._notes: dict[Note, None] = {}
        self._log_characters = 0
        self.logs_dropped = 0

    @property
    def logs(self) -> tuple[LogRecord, ...]:
        """Records in order of time."""
        return tuple(self._logs)

    @property
    def notes(self) -> tuple[Note, ...]:
        """Notes in the order in which they were first made."""
        return tuple(self._notes)

    def log(self, t_ns: int, payload: bytes) -> None:
        """Take a message on /rosout.

        Raises:
            ProtocolError: it is not a readable log message.
        """
        if len(self._logs) >= MAX_LOGS or self._log_characters >= MAX_LOG_TEXT:
            self.logs_dropped += 1
            return
        values = decode(LOG, payload)
        level = values["level"]
        if level not in LOG_LEVELS:
            raise ProtocolError(f"log record of level {level}")
        name, message = values["name"][:MAX_TEXT], values["msg"][:MAX_TEXT]
        self._log_characters += len(name) + len(message)
        self._logs.append(LogRecord(t_ns=t_ns, level=level, name=name, message=message))

    def note(self, code: str, text: str = "") -> None:
        """Make a note; the same one twice is made once.

        Raises:
            ProtocolError: `code` is not a plain word.
        """
        if not _CODE.fullmatch(code):
            raise ProtocolError("NOTE.code is not a plain word")
        if len(self._notes) < MAX_NOTES:
            self._notes[Note(code=code, text=text[:MAX_TEXT])] = None
