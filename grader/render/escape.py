"""Text from students made safe to show: nothing in it can move a cursor, hide, reorder or mark up."""

import html
import unicodedata

_HIDDEN_CATEGORIES = frozenset({"Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp"})
"""Controls, format characters (bidi marks, joiners), surrogates, private use, unassigned, separators."""

_BLANK_LETTERS = frozenset("\u034f\u115f\u1160\u17b4\u17b5\u3164\uffa0")
"""Unicode calls these letters or marks, terminals show nothing (Default_Ignorable_Code_Point)."""


def _hidden(character: str) -> bool:
    return unicodedata.category(character) in _HIDDEN_CATEGORIES or character in _BLANK_LETTERS


def _escaped(character: str) -> str:
    code = ord(character)
    if code <= 0xFF:
        return f"\\x{code:02x}"
    return f"\\u{code:04x}" if code <= 0xFFFF else f"\\U{code:08x}"


def visible(text: str) -> str:
    r"""Return `text` with invisible and controlling characters as Python escapes (``\x1b``, ``\u202e``).

    Line feeds stay (``\r\n`` counts as one) and a tab becomes four spaces; everything printable is unchanged.
    Applying it twice changes nothing more.
    """
    plain = text.replace("\r\n", "\n").replace("\t", "    ")
    if plain.isascii() and plain.isprintable():
        return plain
    return "".join(
        _escaped(character) if character != "\n" and _hidden(character) else character for character in plain
    )


def visible_line(text: str, limit: int | None = None) -> str:
    r"""Return `visible` text on one line: line feeds as ``\n``, cut to `limit` characters with ``…``."""
    line = visible(text).replace("\n", "\\n")
    return line if limit is None or len(line) <= limit else line[: limit - 1] + "…"


def visible_html(text: str) -> str:
    """Return `visible` text for an HTML element or a quoted attribute value."""
    return html.escape(visible(text), quote=True)
