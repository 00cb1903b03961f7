"""The machinery's sentences about a run (`RunOutcome.detail`), in both languages.

Sandbox and script process say in English what was refused, used up or waited for; here the known sentences are put
into the catalogs' words. An unknown one is quoted as it came.
"""

import re

from grader.contracts.outcome import RunStatus
from grader.contracts.text import EMPTY, Text
from grader.messages import say
from grader.messages.stalls import stall

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
    "more than (?P<limit>[\\d.e+]+) s of CPU time were used": "cpu",
    "more than (?P<limit>\\d+) bytes were printed": "output",
    "the script waits in a call that nothing can end": "asleep",
    "the process was ended by (?P<signal>SIG\\w+)": "signal",
    "(?P<signal>SIG\\w+) with all memory in use": "memory",
    "the host ran out of memory, and this script had its fill": "host_memory",
}
_PATTERNS = {re.compile(pattern, re.DOTALL): code for pattern, code in _KNOWN.items()}


def explained(status: RunStatus, detail: str) -> Text:
    """Return what `detail`, of a run that ended with `status`, says; nothing when it is empty.

    How a script broke the wire format helps nobody who reads a report: of that, only the fact is told.
    """
    if not detail:
        return EMPTY
    if status is RunStatus.PROTOCOL:
        return say("detail.protocol")
    for pattern, code in _PATTERNS.items():
        if (match := pattern.fullmatch(detail)) is not None:
            return say(f"detail.{code}", what=detail, **match.groupdict())
    return stall(detail) if status is RunStatus.STALLED else Text(zh=detail, en=detail)
