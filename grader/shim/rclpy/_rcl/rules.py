"""Rules on a command line, as the lexer and parser of rcl read them: refused with their texts."""

from __future__ import annotations

import re

NONE, EOF, TILDE_SLASH, SERVICE_URL, TOPIC_URL, COLON, NODE, NS, SEPARATOR, BACK_REFERENCE = range(10)
TOKEN, SLASH, WILD_ONE, WILD_MULTI, DOT = range(18, 23)  # as rcl counts them; the back references are 9 to 17

_LEXEMES = (
    (SERVICE_URL, r"rosservice://"),
    (TOPIC_URL, r"rostopic://"),
    (NODE, r"__(?:node|name)"),
    (NS, r"__ns"),
    (NONE, r"__"),
    (TOKEN, r"[A-Za-z](?:_?[A-Za-z0-9])*_?|_(?:[A-Za-z0-9](?:_?[A-Za-z0-9])*_?)?"),
    (TILDE_SLASH, r"~/"),
    (SLASH, r"/"),
    (SEPARATOR, r":="),
    (COLON, r":"),
    (WILD_MULTI, r"\*\*"),
    (WILD_ONE, r"\*"),
    (BACK_REFERENCE, r"\\[1-9]"),
    (DOT, r"\."),
)
_LEXEME = re.compile("|".join(f"(?P<_{kind}_{i}>{text})" for i, (kind, text) in enumerate(_LEXEMES)))
_UNSET = "error not set"


class Remap:
    """One rule ``[node:][scheme]from:=to``; `kind` is ``node``, ``ns``, ``topic``, ``service`` or ``any``."""

    __slots__ = ("kind", "match", "node", "replacement")

    def __init__(self, node: str | None, kind: str, match: str, replacement: str) -> None:
        self.node = node
        self.kind = kind
        self.match = match
        self.replacement = replacement


class _Lexer:
    def __init__(self, text: str) -> None:
        self.text = text
        self.at = 0

    def peek(self) -> int:
        """Return the kind of the next lexeme."""
        return self._lexeme(self.at)[0]

    def peek_second(self) -> int:
        """Return the kind of the lexeme after the next one."""
        return self._lexeme(self._lexeme(self.at)[1])[0]

    def accept(self) -> None:
        """Go on behind the next lexeme."""
        self.at = self._lexeme(self.at)[1]

    def expect(self, kind: int) -> None:
        """Go on behind a lexeme of `kind`; ValueError if it is another."""
        lexeme = self.peek()
        if lexeme != kind:
            if lexeme in (NONE, EOF):
                text = f"Expected lexeme type ({kind}) not found, search ended at index {self.at}, "
                raise ValueError(text + "at ./src/rcl/lexer_lookahead.c:239")
            text = f"Expected lexeme type {kind}, got {lexeme} at index {self.at}, "
            raise ValueError(text + "at ./src/rcl/lexer_lookahead.c:244")
        self.accept()

    def _lexeme(self, at: int) -> tuple[int, int]:
        if at >= len(self.text):
            return EOF, at
        match_ = _LEXEME.match(self.text, at)
        if match_ is None:
            return NONE, at + 1
        kind = int(str(match_.lastgroup).split("_")[1])
        return (kind + int(match_[0][1]) - 1 if kind == BACK_REFERENCE else kind), match_.end()


def read_remap(rule: str) -> Remap:
    """Return the remap rule that `rule` is. Raises ValueError: it is none; the message is rcl's."""
    lexer = _Lexer(rule)
    node = _node_prefix(lexer)
    first = lexer.peek()
    if first in (NODE, NS):
        lexer.accept()
        lexer.expect(SEPARATOR)
        begin = lexer.at
        if first == NODE:
            _new_node_name(lexer)
        else:
            _new_namespace(lexer)
        remap = Remap(node, "node" if first == NODE else "ns", "", rule[begin : lexer.at])
    else:
        remap = _name_remap(lexer, node)
    lexer.expect(EOF)
    return remap


def read_parameter_rule(rule: str) -> tuple[str, str, str]:
    """Return the pattern of nodes, the parameter's name and its value's YAML.

    Raises ValueError: `rule` is no rule; the message is rcl's.
    """
    lexer = _Lexer(rule)
    node = _node_prefix(lexer)
    begin = lexer.at
    _parameter_token(lexer)
    while lexer.peek() != SEPARATOR:
        lexer.expect(DOT)
        _parameter_token(lexer)
    name = rule[begin : lexer.at]
    lexer.accept()
    return "/**" if node is None else f"/{node}", name, rule[lexer.at :]


def read_level_rule(rule: str) -> tuple[str, str]:
    """Return the logger's name, empty for all of them, and the level's name.

    Raises ValueError: `rule` is no rule; the message is rcl's.
    """
    lexer = _Lexer(rule)
    while lexer.peek() != SEPARATOR:
        lexer.accept()
        if lexer.peek() == EOF:
            return "", rule
    name = rule[: lexer.at]
    if not name:
        text = "Argument has an invalid logger item that name is empty"
        raise ValueError(f"{text}, at ./src/rcl/arguments.c:1754")
    lexer.accept()
    begin = lexer.at
    lexer.expect(TOKEN)
    lexer.expect(EOF)
    return name, rule[begin:]


def _node_prefix(lexer: _Lexer) -> str | None:
    begin = lexer.at
    if lexer.peek() != TOKEN or lexer.peek_second() != COLON:
        return None
    lexer.accept()
    end = lexer.at
    lexer.accept()
    return lexer.text[begin:end]


def _new_node_name(lexer: _Lexer) -> None:
    from rclpy._rcl import logs

    if lexer.peek() != TOKEN:
        logs.warn("rcl", f"Node name not remapped to invalid name: '{lexer.text[lexer.at :]}'")
    lexer.expect(TOKEN)


def _new_namespace(lexer: _Lexer) -> None:
    from rclpy._rcl import logs

    begin = lexer.at
    try:
        lexer.expect(SLASH)
        while lexer.peek() == TOKEN:
            lexer.accept()
            if lexer.peek() == SLASH:
                lexer.accept()
        lexer.expect(EOF)
    except ValueError:
        rest = lexer.text[begin:]
        logs.warn("rcl", f"Namespace not remapped to a fully qualified name (found: {rest})")
        raise


def _name_remap(lexer: _Lexer, node: str | None) -> Remap:
    kind = {SERVICE_URL: "service", TOPIC_URL: "topic"}.get(lexer.peek(), "any")
    if kind != "any":
        lexer.accept()
    begin = lexer.at
    if lexer.peek() in (TILDE_SLASH, SLASH):
        lexer.accept()
    _token_to_match(lexer)
    while lexer.peek() != SEPARATOR:
        lexer.expect(SLASH)
        _token_to_match(lexer)
    match = lexer.text[begin : lexer.at]
    lexer.accept()
    begin = lexer.at
    if lexer.peek() in (TILDE_SLASH, SLASH):
        lexer.accept()
    _token_of_replacement(lexer)
    while lexer.peek() != EOF:
        lexer.expect(SLASH)
        _token_of_replacement(lexer)
    return Remap(node, kind, match, lexer.text[begin : lexer.at])


def _token_to_match(lexer: _Lexer) -> None:
    if lexer.peek() != TOKEN:
        raise ValueError(_refused(lexer.peek(), 1164))
    lexer.accept()


def _token_of_replacement(lexer: _Lexer) -> None:
    lexeme = lexer.peek()
    if BACK_REFERENCE <= lexeme < TOKEN:
        raise ValueError("Backreferences are not implemented, at ./src/rcl/arguments.c:1059")
    if lexeme != TOKEN:
        raise ValueError(_UNSET)
    lexer.accept()


def _parameter_token(lexer: _Lexer) -> None:
    if lexer.peek() not in (TOKEN, SLASH):
        raise ValueError(_refused(lexer.peek(), 1267))
    while lexer.peek() in (TOKEN, SLASH):
        lexer.accept()


def _refused(found: int, line: int) -> str:
    wild = {
        WILD_ONE: ("Wildcard '*' is not implemented", 0),
        WILD_MULTI: ("Wildcard '**' is not implemented", 3),
    }
    text, further = wild.get(found, ("Expecting token or wildcard", 6))
    return f"{text}, at ./src/rcl/arguments.c:{line + further}"
