"""Why a script stalled, in both languages.

The script's process says in English which thread waits in which line for what, one clause per thread; here the
known reasons are put into the catalogs' words. An unknown one is quoted as it came.
"""

import re

from grader.contracts.text import Text
from grader.messages import join, say

_CLAUSE = re.compile(r"(?P<thread>[^:;]*?)(?:, line (?P<line>\d+))?: (?P<reason>.*)", re.DOTALL)
_REASONS = {
    re.compile(r"rate\.sleep\(\) waits for a timer of its node.*"): "rate",
    re.compile(r"(?P<call>\S+) waits for an answer, but no executor.*"): "answer",
    re.compile(r"spin_once\(\) waits for .*"): "spin_once",
    re.compile(r"wait_for_message\(\) waits for a message on (?P<topic>.+)"): "message",
    re.compile(r"the end of the program waits for the other threads"): "threads",
    re.compile(r"(?P<call>\S+) waits for ever"): "call",
}
_MAIN = "main thread"
_MAIN_THREAD = Text(zh="主线程", en=_MAIN)
_SEPARATOR = Text(zh="；", en="; ")


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
        if (match := pattern.fullmatch(text)) is not None:
            return say(f"stall.{code}", **match.groupdict())
    return Text(zh=text, en=text)
