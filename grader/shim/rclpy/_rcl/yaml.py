"""YAML as events, as far as parameter files and ``-p name:=value`` use it.

Block and flow collections, plain and quoted scalars, comments, several documents. Anchors and tags are skipped.
Block scalars (``|``, ``>``) and explicit keys (``?``) are refused although libyaml reads them: no parameter needs
them.
"""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator

SCALAR, SEQUENCE, SEQUENCE_END, MAPPING, MAPPING_END, ALIAS = range(6)

_BLANK = " \t\n"
_FLOW = ",[]{}"
_NEVER_FIRST = ",[]{}#&*!|>'\"%@`"
_ESCAPES = {
    **dict(zip("0abtnvfre", "\0\a\b\t\n\v\f\r\x1b", strict=True)),
    **{character: character for character in ' "/\\\t'},
    "N": "\x85",
    "_": "\xa0",
    "L": "\u2028",
    "P": "\u2029",
}
_NUMBERED = {"x": 2, "u": 4, "U": 8}


class YamlError(ValueError):
    """The text is not YAML, or uses a part of YAML that is not supported."""


class YamlEvent:
    """One event of the stream; `text` and `quoted` are a scalar's, `line` counts from 1."""

    __slots__ = ("kind", "line", "quoted", "text")

    def __init__(self, kind: int, line: int, text: str = "", quoted: bool = False) -> None:
        self.kind = kind
        self.line = line
        self.text = text
        self.quoted = quoted


def events(text: str) -> Iterator[YamlEvent]:
    """Yield the events of a text.

    Raises:
        YamlError: where the text is no YAML; the events before it are yielded.
    """
    reader = _Reader(text.replace("\r\n", "\n").replace("\r", "\n").removeprefix("\ufeff"))
    while reader.begins_document():
        yield from reader.node(-1)


class _Reader:
    def __init__(self, text: str) -> None:
        self._text = text
        self._at = 0

    # Characters -----------------------------------------------------------------------------------

    def _next(self, ahead: int = 0) -> str:
        return self._text[self._at + ahead : self._at + ahead + 1]

    def _column(self) -> int:
        return self._at - (self._text.rfind("\n", 0, self._at) + 1)

    def _line(self) -> int:
        return self._text.count("\n", 0, self._at) + 1

    def _ends_word(self, ahead: int) -> bool:
        """Whether a blank or the end of the text stands there."""
        return not self._next(ahead) or self._next(ahead) in _BLANK

    def _skip(self, blanks: str = _BLANK) -> None:
        """Go past blanks and comments (with spaces and tabs only: up to the end of the line)."""
        while self._next() and self._next() in blanks:
            self._at += 1
        if self._next() == "#":  # within a word it never is the next character here
            end = self._text.find("\n", self._at)
            self._at = len(self._text) if end < 0 else end
            if "\n" in blanks:
                self._skip(blanks)

    def _marks_document(self) -> bool:
        return self._text.startswith(("---", "..."), self._at) and not self._column() and self._ends_word(3)

    def begins_document(self) -> bool:
        """Go to the next document; False at the end of the text."""
        first = not self._at
        self._skip()
        marked = False
        while self._marks_document():
            marked = self._next() == "-"
            self._at += 3
            self._skip()
        if not self._next():
            return False
        if not (first or marked):
            raise YamlError("something stands after the document")
        return True

    # Nodes ----------------------------------------------------------------------------------------

    def node(self, indent: int, *, in_flow: bool = False) -> Iterator[YamlEvent]:
        """Yield the events of the node that begins here, inside a block whose lines begin at column `indent`."""
        self._skip_properties()
        line, first = self._line(), self._next()
        indentation = self._indentation()
        if not in_flow and "\t" in indentation and not indentation.strip():
            raise YamlError("a tab in the indentation")
        if not first:
            yield YamlEvent(SCALAR, line)
        elif first == "*":
            self._word()
            yield YamlEvent(ALIAS, line)
        elif first in ("[", "{"):
            yield from self._sequence_in_flow() if first == "[" else self._mapping_in_flow()
        elif not in_flow and first == "-" and self._ends_word(1):
            yield from self._block_sequence(self._column())
        elif not in_flow and self._begins_pair():
            yield from self._block_mapping(self._column())
        else:
            yield self._scalar(indent, in_flow)

    def _skip_properties(self) -> None:
        while self._next() in ("&", "!"):
            self._word()
            self._skip()

    def _word(self) -> None:
        while not self._ends_word(0) and self._next() not in _FLOW:
            self._at += 1

    def _begins_pair(self) -> bool:
        """Whether a key and its colon stand here, on one line."""
        start, line = self._at, self._line()
        try:
            self._scalar(len(self._text), in_flow=False)
        except YamlError:
            return False
        else:
            self._skip(" \t")
            return self._next() == ":" and self._ends_word(1) and self._line() == line
        finally:
            self._at = start

    def _block_sequence(self, column: int) -> Iterator[YamlEvent]:
        yield YamlEvent(SEQUENCE, self._line())
        while self._column() == column and self._next() == "-" and self._ends_word(1):
            self._at += 1
            yield from self._value(column)
        yield YamlEvent(SEQUENCE_END, self._line())

    def _block_mapping(self, column: int) -> Iterator[YamlEvent]:
        yield YamlEvent(MAPPING, self._line())
        while self._next() and self._column() == column and not self._marks_document():
            if not self._begins_pair():
                raise YamlError("a key without a value")
            yield self._scalar(len(self._text), in_flow=False)
            self._skip(" \t")
            self._at += 1
            yield from self._value(column, of_key=True)
        yield YamlEvent(MAPPING_END, self._line())

    def _value(self, column: int, *, of_key: bool = False) -> Iterator[YamlEvent]:
        """Yield the value after a colon or dash of a block at `column`, and go to the next line of content."""
        line = self._line()
        self._skip()
        same_line = self._line() == line
        # a key's list may be as far in as the key
        listed = of_key and self._next() == "-" and self._ends_word(1)
        if not self._next() or (
            not same_line and (self._column() < column + (not listed) or self._marks_document())
        ):
            yield YamlEvent(SCALAR, line)
        elif of_key and same_line and (listed or self._begins_pair()):
            raise YamlError("a block begins in the line of its key")
        else:
            yield from self.node(column)
        self._end_line(column)

    def _end_line(self, column: int) -> None:
        """Go from the end of a value of a block at `column` to the next line of content."""
        if self._indentation().strip():  # else the value was a block, which has gone to the next line itself
            self._skip(" \t")
            if self._next() not in ("", "\n"):
                raise YamlError("something stands after a value")
            self._skip()
        if self._next() and self._column() > column:
            raise YamlError("a line is indented deeper than its block")

    def _indentation(self) -> str:
        """Return what stands before this place in its line."""
        return self._text[self._text.rfind("\n", 0, self._at) + 1 : self._at]

    # Flow -----------------------------------------------------------------------------------------

    def _sequence_in_flow(self) -> Iterator[YamlEvent]:
        yield YamlEvent(SEQUENCE, self._line())
        self._at += 1
        self._skip()
        while self._next() != "]":
            yield from self.node(-1, in_flow=True)
            self._end_item("]")
        yield YamlEvent(SEQUENCE_END, self._line())
        self._at += 1

    def _mapping_in_flow(self) -> Iterator[YamlEvent]:
        yield YamlEvent(MAPPING, self._line())
        self._at += 1
        self._skip()
        while self._next() != "}":
            yield self._scalar(-1, in_flow=True)
            self._skip()
            if self._next() == ":":
                self._at += 1
                self._skip()
            if self._next() and self._next() in ",}":
                yield YamlEvent(SCALAR, self._line())
            else:
                yield from self.node(-1, in_flow=True)
            self._end_item("}")
        yield YamlEvent(MAPPING_END, self._line())
        self._at += 1

    def _end_item(self, closing: str) -> None:
        self._skip()
        if self._next() == ",":
            self._at += 1
            self._skip()
        elif self._next() != closing:
            raise YamlError("a collection is not closed")

    # Scalars --------------------------------------------------------------------------------------

    def _scalar(self, indent: int, in_flow: bool) -> YamlEvent:
        line, first = self._line(), self._next()
        if first and first in "'\"":
            return YamlEvent(SCALAR, line, self._quoted(first), quoted=True)
        bare = first in ("-", "?", ":") and self._ends_word(1)
        if not first or first in _NEVER_FIRST or bare:
            raise YamlError(f"no value can begin with {first!r}")
        words = self._plain_line(in_flow)
        while fold := self._fold(indent, line, in_flow):
            words += fold + self._plain_line(in_flow)
        return YamlEvent(SCALAR, line, words)

    def _blank_lines(self) -> str:
        """Skip blanks and return what they stand for in a scalar: a space, or a line feed for each empty line."""
        start = self._at
        while self._next() and self._next() in _BLANK:
            self._at += 1
        return "\n" * (self._text.count("\n", start, self._at) - 1) or " "

    def _fold(self, indent: int, line: int, in_flow: bool) -> str:
        """Go to the next line of a plain scalar and return what stands for the break; empty if it ends here."""
        start = self._at
        fold = self._blank_lines()
        first = self._next()
        if (
            first
            and self._line() > line
            and self._column() > indent
            and not self._marks_document()
            and first not in ("#", *(_FLOW if in_flow else ""))
            and not (first == ":" and self._ends_word(1))
        ):
            return fold
        self._at = start
        return ""

    def _plain_line(self, in_flow: bool) -> str:
        """Return the part of a plain scalar that stands in this line."""
        start = self._at
        while (character := self._next()) and character != "\n":
            if character == ":" and (self._ends_word(1) or (in_flow and self._next(1) in _FLOW)):
                break
            if (character == "#" and self._text[self._at - 1] in _BLANK) or (in_flow and character in _FLOW):
                break
            self._at += 1
        words = self._text[start : self._at].rstrip()
        self._at = start + len(words)
        return words

    def _quoted(self, quote: str) -> str:
        self._at += 1
        text = ""
        while True:
            character = self._next()
            if not character:
                raise YamlError("a quote is not closed")
            self._at += 1
            if character == quote:
                if quote == "'" and self._next() == "'":
                    self._at += 1
                else:
                    return text
            if character == "\n":
                self._at -= 1
                text, character = text.rstrip(" \t"), self._blank_lines()
            if character == "\\" and quote == '"':
                character = self._escape()
            text += character

    def _escape(self) -> str:
        character = self._next()
        self._at += 1
        if character in _NUMBERED:
            digits = self._text[self._at : self._at + _NUMBERED[character]]
            self._at += len(digits)
            try:
                return chr(int(digits, 16))
            except ValueError:
                raise YamlError(f"no character has the number {digits}") from None
        if character == "\n":  # the text goes on in the next line, without its indentation
            self._blank_lines()
            return ""
        if character not in _ESCAPES:
            raise YamlError(f"there is no escape of {character!r}")
        return _ESCAPES[character]
