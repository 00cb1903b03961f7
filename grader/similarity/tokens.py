"""The tokens of a script, without what people change to make a copy look different.

Names, numbers and strings are one token each whatever they say. Comments, docstrings, layout and commas before a
closing bracket are none. Python's own tokenizer would stop at the first mistake, differs from version to version,
and is slow where lines are long: this one reads any text, in time that grows with its length.
"""

import keyword
import re
from dataclasses import dataclass
from typing import Final

MOST_TOKENS: Final = 5_000
"""Most that is read of one script; the lesson's longest has 551."""

_PATTERN = re.compile(
    r"""
      (?P<comment> \#[^\n]* | \\\n | [ \t\f]+ )
    | (?P<string>
        [rbuftRBUFT]{0,2}
        (?: \"\"\" (?: [^"\\] | \\(?:.|\Z) | "(?!"") )*+ (?: \"\"\" )?
          | ''' (?: [^'\\] | \\(?:.|\Z) | '(?!'') )*+ (?: ''' )?
          | " (?: [^"\\\n] | \\(?:.|\Z) )*+ "?
          | ' (?: [^'\\\n] | \\(?:.|\Z) )*+ '? ) )
    | (?P<name> [^\W\d]\w* )
    | (?P<number> 0[xXoObB][\da-fA-F_]+ | (?: \d[\d_]* \.? [\d_]* | \.\d[\d_]* ) (?: [eE][+-]?\d[\d_]* )? [jJ]? )
    | (?P<newline> \n )
    | (?P<operator> \.\.\. | (?: \*\* | // | << | >> | [-+*/%@&|^<>=!] ) = | -> | := | \*\* | // | << | >> | . )
    """,
    re.VERBOSE | re.DOTALL,
)
_OPERATORS = [
    "...", "**=", "//=", "<<=", ">>=", "+=", "-=", "*=", "/=", "%=", "@=", "&=", "|=", "^=", "<=", ">=",
    "==", "!=", "->", ":=", "**", "//", "<<", ">>", "+", "-", "*", "/", "%", "@", "&", "|",
    "^", "~", "<", ">", "=", "(", ")", "[", "]", "{", "}", ",", ":", ".", ";",
]  # fmt: skip
_SPELT = (*keyword.kwlist, *_OPERATORS)
_KINDS = ("name", "number", "string", "newline", "indent", "dedent", "other")
_OF_SPELT, _OF_KIND = (
    {text: chr(first + i) for i, text in enumerate(texts)}
    for first, texts in ((ord("!"), _SPELT), (ord("!") + len(_SPELT), _KINDS))
)
_STRING, _COMMA = _OF_KIND["string"], _OF_SPELT[","]
_TAB = 8


@dataclass(frozen=True, slots=True)
class SourceTokens:
    """The tokens of a script.

    Attributes:
        codes: one ASCII character for each.
        lines: where each begins, from 1.
        cut: whether the script goes on after them.
    """

    codes: str
    lines: list[int]
    cut: bool


def tokens_of(text: str) -> SourceTokens:
    """Return the first `MOST_TOKENS` tokens of a source, which need not be valid Python."""
    reader = _Reader()
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    for match in _PATTERN.finditer(text):
        reader.take(match)
        if len(reader.codes) >= MOST_TOKENS:
            return SourceTokens("".join(reader.codes), reader.lines, cut=match.end() < len(text))
    reader.end_line()
    return SourceTokens("".join(reader.codes), reader.lines, cut=False)


class _Reader:
    """Turns matches into tokens; knows brackets and indentation."""

    def __init__(self) -> None:
        self.codes: list[str] = []
        self.lines: list[int] = []
        self._line = 1
        self._line_at = 0  # where in the text the line begins
        self._begun: int | None = None  # the first token of the statement's line; None: none yet
        self._depth = 0
        self._columns = [0]

    def take(self, match: re.Match[str]) -> None:
        """Read what was matched."""
        kind, said = match.lastgroup, match[0]
        if kind == "newline":
            if not self._depth:
                self.end_line()
        elif kind != "comment":
            if self._begun is None:
                self._begin(match)
            self._token(str(kind), said)
        if "\n" in said:
            self._line += said.count("\n")
            self._line_at = match.start() + said.rindex("\n") + 1

    def end_line(self) -> None:
        """End a statement's line; one that only says a string is a docstring or a comment."""
        if self._begun is None:
            return
        if self.codes[self._begun :] == [_STRING]:
            self.codes.pop()
            self.lines.pop()
        else:
            self._add("newline")
        self._begun = None

    def _begin(self, match: re.Match[str]) -> None:
        column = len(match.string[self._line_at : match.start()].expandtabs(_TAB))
        if column > self._columns[-1]:
            self._columns.append(column)
            self._add("indent")
        while column < self._columns[-1]:
            self._columns.pop()
            self._add("dedent")
        self._begun = len(self.codes)

    def _token(self, kind: str, said: str) -> None:
        if kind == "operator":
            self._brackets(said)
        if kind == "string" and self.codes[-1:] == [_STRING] and len(self.codes) != self._begun:
            return  # strings side by side are one
        self._add(kind if kind != "operator" else "other", said)

    def _brackets(self, said: str) -> None:
        if said in "([{":
            self._depth += 1
        elif said in ")]}":
            self._depth = max(self._depth - 1, 0)
            if self.codes[-1:] == [_COMMA]:
                self.codes.pop()
                self.lines.pop()

    def _add(self, kind: str, said: str = "") -> None:
        self.codes.append(_OF_SPELT.get(said) or _OF_KIND[kind])
        self.lines.append(self._line)
