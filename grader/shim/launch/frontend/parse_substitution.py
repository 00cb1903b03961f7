"""Texts with substitutions in them: ``$(var name)``, ``$(env HOME '')``, ``$(find-pkg-share $(var package))``."""

from __future__ import annotations

import re

from launch import substitutions
from launch._evaluation import Substitution
from launch.substitutions import TextSubstitution

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_KNOWN = {
    "and": ("AndSubstitution", 2, 2),
    "anon": ("AnonName", 1, 1),
    "command": ("Command", 1, 1),
    "dirname": ("ThisLaunchFileDir", 0, 0),
    "env": ("EnvironmentVariable", 1, 2),
    "eval": ("PythonExpression", 1, 1),
    "exec-in-pkg": ("ExecutableInPackage", 2, 2),
    "filename": ("ThisLaunchFile", 0, 0),
    "find-exec": ("FindExecutable", 1, 1),
    "find-pkg-prefix": ("FindPackagePrefix", 1, 1),
    "find-pkg-share": ("FindPackageShare", 1, 1),
    "not": ("NotSubstitution", 1, 1),
    "or": ("OrSubstitution", 2, 2),
    "param": ("Parameter", 1, 1),
    "var": ("LaunchConfiguration", 1, 2),
}
"""The class of each substitution, and how many arguments it takes."""
_IDENTIFIER = re.compile(r"\$\(([A-Za-z][A-Za-z0-9_-]*)")


def parse_substitution(string_value: str) -> list[Substitution]:
    """Return the texts and the substitutions that a text consists of.

    Raises:
        ValueError: a substitution is written wrongly. RuntimeError: there is none of that name.
        TypeError: it takes another number of arguments.
    """
    parser = _Parser(string_value)
    parts = parser.parts("")
    return parts or [TextSubstitution(text=string_value)]


class _Parser:
    def __init__(self, text: str) -> None:
        self._text = text
        self._at = 0

    def parts(self, end: str) -> list[Substitution]:
        """Return what stands before one of the characters of `end`; without them, up to the end of the text."""
        found: list[Substitution] = []
        plain = ""
        while self._at < len(self._text) and self._text[self._at] not in end:
            if self._text.startswith("$(", self._at):
                if plain:
                    found.append(TextSubstitution(text=plain))
                plain = ""
                found.append(self._substitution(in_quotes=bool(end) and end in "'\""))
            else:
                if self._text[self._at] == "\\" and self._at + 1 < len(self._text):
                    self._at += 1
                plain += self._text[self._at]
                self._at += 1
        return [*found, TextSubstitution(text=plain)] if plain else found

    def _substitution(self, *, in_quotes: bool) -> Substitution:
        begin = self._at
        match = _IDENTIFIER.match(self._text, begin)
        if match is None:
            raise ValueError(f"no substitution: {self._text[begin : begin + 40]!r}")
        self._at = match.end()
        arguments = []
        while self._text.startswith(" ", self._at):
            self._at += 1
            quote = self._text[self._at : self._at + 1]
            if quote and quote in "'\"" and not in_quotes:
                self._at += 1
                arguments.append(self.parts(quote) or [TextSubstitution(text="")])
                self._at += 1
            else:
                arguments.append(self.parts(" )"))
        if not self._text.startswith(")", self._at) or [] in arguments:
            raise ValueError(f"no substitution: {self._text[begin : begin + 40]!r}")
        self._at += 1
        return _substitution_of(match[1], arguments)


def _substitution_of(name: str, arguments: list[list[Substitution]]) -> Substitution:
    if name not in _KNOWN:
        raise RuntimeError(f"Unknown substitution: {name}")
    class_name, fewest, most = _KNOWN[name]
    if not fewest <= len(arguments) <= most:
        expected = f"{fewest} or {most}" if fewest < most else str(most)
        raise TypeError(f"{name} substitution expects {expected} argument{'s' if most > 1 else ''}")
    of: Any = substitutions
    if not hasattr(of, class_name):
        from importlib import import_module

        of = import_module("launch_ros.substitutions")
    substitution: Any = getattr(of, class_name)
    key = {"env": "default_value", "find-exec": "name", "var": "default"}.get(name)
    named = {key: arguments.pop()} if key and len(arguments) == most else {}
    result: Substitution = substitution(*arguments, **named)
    return result
