"""Lines of a program that a sentence names, as links to where the page shows them."""

import re

from markupsafe import Markup

from grader.render.escape import visible_html

_NAMED = re.compile(r"第 ?(\d{1,5}) ?行|\b[Ll]ines? (\d{1,5})\b")


def lines_named(sentence: str) -> tuple[int, ...]:
    """Return the numbers of the lines that a sentence of either language names, in its order."""
    return tuple(int(found[1] or found[2]) for found in _NAMED.finditer(sentence))


def linked(sentence: str, last: int) -> Markup:
    """Return a sentence whose lines up to `last` are links to ``#L<number>``; control characters are shown."""
    parts: list[str] = []
    end = 0
    for found in _NAMED.finditer(sentence):
        number = int(found[1] or found[2])
        if 1 <= number <= last:
            parts.append(f'{visible_html(sentence[end : found.start()])}<a href="#L{number}">{found[0]}</a>')
            end = found.end()
    parts.append(visible_html(sentence[end:]))
    return Markup("".join(parts))  # noqa: S704  escaped piece by piece
