"""What a script printed, without what is shown apart from it."""

import re
from collections.abc import Sequence
from dataclasses import replace

from grader.contracts.outcome import LogRecord, Stream

_LOGGED = re.compile(r"\[([A-Z]+)\] \[\d+\.\d{9}\] \[(.*?)\]: (.*)")
"""A log message as rclpy writes it to the console: level, instant, name, text."""

_LONGEST_LOG_LINES = 20
"""A message of more lines is not looked for in the output: it is shown twice."""


def without_logs(stream: Stream, logs: Sequence[LogRecord]) -> Stream:
    """Return captured output without the log messages that are shown by themselves."""
    shown = {(log.level_name, log.name, *log.message.split("\n")) for log in logs}
    lines = stream.text.split("\n")
    kept, at = [], 0
    while at < len(lines):
        head = _LOGGED.fullmatch(lines[at])
        sizes = () if head is None else range(1, _LONGEST_LOG_LINES + 1)
        size = next((n for n in sizes if head and (*head.groups(), *lines[at + 1 : at + n]) in shown), 0)
        if size == 0:
            kept.append(lines[at])
        at += max(size, 1)
    return replace(stream, text="\n".join(kept))
