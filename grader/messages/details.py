"""What the sandbox says about a run (`RunOutcome.detail`), in both languages.

The sandbox and the script's process say in English what was refused or used up, and which thread waits in which
line for what. Known sentences are replaced by messages; an unknown one is quoted as it came.
"""

import re

from grader.contracts.outcome import RunStatus
from grader.contracts.text import EMPTY, Text
from grader.messages import join, say

_CHANGES = "os\\.(?:remove|rename|rmdir|mkdir|chmod|chown|link|symlink|truncate)|shutil\\.\\w+"
_PROGRAMS = "subprocess\\.Popen|os\\.(?:fork|forkpty|system|exec|posix_spawn|spawn)"
_TARGET = "(?:: .*)?"
_KNOWN = {
    "open for writing: (?P<target>.*)": "writing",
    f"(?:{_CHANGES}){_TARGET}": "files",
    f"(?:{_PROGRAMS}){_TARGET}": "program",
    f"os\\.kill{_TARGET}": "signalling",
    f"socket\\.\\w+{_TARGET}": "network",
    "a system call of another architecture was made": "architecture",
    "more than (?P<limit>\\d+) steps were made": "steps",
    "more than (?P<limit>[\\d.e+]+) s of CPU time were used": "cpu",
    "more than (?P<limit>\\d+) bytes were printed": "output",
    "the script waits in a call that nothing can end": "asleep",
    "the process was ended by (?P<signal>SIG\\w+)": "signal",
    "(?P<signal>SIG\\w+) with all memory in use": "memory",
    "the host ran out of memory, and this script had its fill": "host_memory",
}
_CLAUSE = re.compile(r"(?P<thread>[^:;]*?)(?:, line (?P<line>\d+))?: (?P<reason>.*)", re.DOTALL)
_REASONS = {
    r"rate\.sleep\(\) waits for a timer of its node.*": "rate",
    r"(?P<call>.+?) waits for an answer, but no executor.*": "answer",
    r"spin_once\(\) waits for .*": "spin_once",
    r"wait_for_message\(\) waits for a message on (?P<topic>.+)": "message",
    r"the end of the program waits for the other threads": "threads",
    r"(?P<call>\S+) waits for ever": "call",
}
_MAIN = "main thread"
_MAIN_THREAD = Text(zh="主线程", en=_MAIN)
_SEPARATOR = Text(zh="；", en="; ")


def explained(status: RunStatus, detail: str) -> Text:
    """Return a run's `detail` in both languages, empty if it is empty; the run ended with `status`.

    For a broken wire format there is one sentence: its details help no reader of a report.
    """
    if not detail:
        return EMPTY
    if status is RunStatus.PROTOCOL:
        return say("detail.protocol")
    for pattern, code in _KNOWN.items():
        if (match := re.fullmatch(pattern, detail, re.DOTALL)) is not None:
            fields = match.groupdict() | ({"limit": _size(int(match["limit"]))} if code == "output" else {})
            return say(f"detail.{code}", what=detail, **fields)
    return stall(detail) if status is RunStatus.STALLED else Text(zh=detail, en=detail)


def _size(count_bytes: int) -> str:
    """Return a limit in MiB, as in ``4 MiB``, or in KiB; in bytes if it is no whole number of KiB."""
    for name, unit in (("MiB", 1 << 20), ("KiB", 1 << 10)):
        if count_bytes % unit == 0:
            return f"{count_bytes // unit} {name}"
    return f"{count_bytes} B"


def stall(detail: str) -> Text:
    """Return the account of a stall in both languages; `detail` is what the script's process said."""
    return join([_clause(part) for part in detail.split("; ")], _SEPARATOR)


def _clause(text: str) -> Text:
    match = _CLAUSE.fullmatch(text)
    if match is None:
        return Text(zh=text, en=text)
    reason = _reason(match["reason"])
    thread = _MAIN_THREAD if match["thread"] == _MAIN else match["thread"]
    if match["line"] is None:
        return say("stall.thread", thread=thread, reason=reason)
    return say("stall.place", thread=thread, line=match["line"], reason=reason)


def _reason(text: str) -> Text:
    for pattern, code in _REASONS.items():
        if (match := re.fullmatch(pattern, text)) is not None:
            return say(f"stall.{code}", **match.groupdict())
    return Text(zh=text, en=text)
