"""Sentences in the terminal: lines that break as Chinese and English are printed.

rich breaks at spaces only and takes a Chinese sentence for one long word: lines end early, and a full stop may
stand alone on the next one.
"""

import re
from collections.abc import Iterator
from typing import Any

from rich.cells import cell_len
from rich.console import Console
from rich.containers import Lines
from rich.text import Text

from grader.messages.quantity import SUFFIXES

_NEVER_FIRST = frozenset("，。、；：！？）》」』】”’…％%°,.;:!?)]}")
_NEVER_LAST = frozenset("（《「『【“‘([{")
_UNIT = re.compile(rf"\d(?:{'|'.join(map(re.escape, SUFFIXES))})(?![\w/])", re.ASCII)
_WIDE = 2


class Prose(Text):
    """A text of sentences."""

    def wrap(self, console: Console, width: int, **_: Any) -> Lines:
        """Return the lines of at most `width` columns; `console` and rich's other wishes make no difference."""
        lines = Lines()
        for paragraph in self.split("\n", allow_blank=True):
            lines.extend(paragraph.divide(breaks(paragraph.plain, width)))
        for line in lines:
            line.rstrip()
        return lines


def breaks(text: str, width: int) -> Iterator[int]:
    """Yield where lines of `text`, which has no line break, begin after the first, each offset once.

    A line breaks before a word or between Chinese characters. It never breaks between a number and its unit,
    before closing punctuation or after opening punctuation, unless nothing else fits into `width` columns.
    """
    begin, best, columns = 0, 0, 0
    for offset, character in enumerate(text):
        if offset > begin and _may_begin(text, offset):
            best = offset
        columns += cell_len(character)
        if columns > width and offset > begin and not character.isspace():
            begin = best if best > begin else offset
            columns = cell_len(text[begin : offset + 1])
            yield begin


def _may_begin(text: str, offset: int) -> bool:
    before, character = text[offset - 1], text[offset]
    if character.isspace():
        return False
    if before.isspace():
        return _UNIT.match(text, max(offset - 2, 0)) is None
    if character in _NEVER_FIRST or before in _NEVER_LAST:
        return False
    return _WIDE in (cell_len(before), cell_len(character))
