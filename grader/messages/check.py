"""Find what is wrong with the messages: ``python -m grader.messages.check``.

It looks for ids without a sentence in one of the languages, sentences with other fields in one language than in
the other, ids that the code names and nobody wrote, and sentences that no code can name. It reads the source, so
an id must stand there as a whole, as an f-string whose parts stand there too (``f"mistake.{code}"`` with the code
``"too_short"`` somewhere), or in a template as ``say('upload.send')`` or ``say('class.show.' ~ kind)``.
"""

import ast
import re
import sys
from collections import Counter
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from string import Formatter
from typing import Final

from grader.contracts.text import LANGUAGES
from grader.messages import FOLDER, entries, file_of
from grader.messages.exceptions import signs

FILES: Final = ("grader", "pages")
_ROOT: Final = FOLDER.parent
_PREFIXES: Final = {"say": "", "sentence": "", "mistake": "mistake.", "word": "word.", "on_page": "page."}
"""Functions that take an id, and what they put before it."""

_MSGID: Final = re.compile(r'^msgid "(.+)"$', re.MULTILINE)
_IN_TEMPLATE: Final = re.compile(r"""["']([a-z0-9_.]+)["']""")
_SAY_CALL: Final = re.compile(r"""\bsay\(\s*["']([a-z0-9_.]+)["']\s*[,)]""")
_JOINED: Final = re.compile(r"""["']([a-z0-9_.]+\.)["'] ~""")
_CHINESE: Final = re.compile("[\u3000-\u303f\u4e00-\u9fff\uff00-\uffef]")
_QUOTES_CHINESE: Final = frozenset({"page.language.name"})
_WRITTEN: Final = (ast.Constant, ast.JoinedStr)


def fields(text: str) -> frozenset[str]:
    """Return the names in braces."""
    return frozenset(name for _, name, _, _ in Formatter().parse(text) if name is not None)


def faults() -> list[str]:
    """Return one line for each thing that is wrong; none when all is well."""
    return [*differences(), *uses(), *pairs()]


def differences() -> Iterator[str]:
    """Compare the languages with each other."""
    for name in FILES:
        texts = {language: entries(language, name) for language in LANGUAGES}
        for language in LANGUAGES:
            ids = _MSGID.findall(file_of(language, name).read_text(encoding="utf-8"))
            for key, count in Counter(ids).items():
                if count > 1:
                    yield f"{language}: {key} stands there {count} times"
                if key not in texts[language]:
                    yield f"{language}: {key} has no msgstr on one line below it"
        for key in sorted(set().union(*texts.values())):
            yield from _compared(key, {language: texts[language].get(key, "") for language in LANGUAGES})


def _compared(key: str, said: Mapping[str, str]) -> Iterator[str]:
    for language, text in said.items():
        if not text.strip():
            yield f"{language}: {key} is missing"
    if all(said.values()) and len({fields(text) for text in said.values()}) > 1:
        listed = "; ".join(f"{language}: {sorted(fields(text))}" for language, text in said.items())
        yield f"{key} has other fields in one language: {listed}"
    if _CHINESE.search(said["en"]) and key not in _QUOTES_CHINESE:
        yield f"en: {key} has Chinese characters"


def uses() -> Iterator[str]:
    """Compare the messages with the source."""
    source = _source()
    keys = {key for name in FILES for key in entries("en", name)}
    for key, place in sorted(source.named.items()):
        if key not in keys and key.replace("page.", "word.", 1) not in keys:  # as `on_page` looks for it
            yield f"{place}: no message {key}"
    for key in sorted(keys):
        if not _used(key):
            yield f"{key} is not used"


@cache
def _used(key: str) -> bool:
    return _source().names(key)


@cache
def _source() -> "_Source":
    return _Source()


class _Source:
    """The texts in the source.

    Attributes:
        literals: every string that stands in it. named: ids given to functions that take one, and where.
        patterns: f-strings with a dot in them, as patterns with a group for each value.
    """

    def __init__(self) -> None:
        self.literals: set[str] = set()
        self.named: dict[str, str] = {}
        self.patterns: set[str] = set()
        for path in sorted(_ROOT.rglob("*.py")):
            if path != Path(__file__):
                self._read_module(path)
        for path in sorted(_ROOT.rglob("*.html")):
            self._read_template(path)
        self.literals.update(code for code, _ in signs())

    def names(self, key: str) -> bool:
        """Whether something in the source can name the message `key`."""
        short = key.removeprefix("page.")
        if {key, short} & self.literals or key in self.named:
            return True
        matches = (re.fullmatch(pattern, one) for pattern in self.patterns for one in {key, short})
        return any(all(map(self._stands, match.groups())) for match in matches if match is not None)

    def _stands(self, part: str) -> bool:
        return part in self.literals or part.isdigit()

    def _read_module(self, path: Path) -> None:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                self.literals.add(node.value)
            elif isinstance(node, ast.JoinedStr):
                self._add_pattern(node)
            elif isinstance(node, ast.keyword) and node.arg is not None:
                self.literals.add(node.arg)
            elif isinstance(node, ast.Call):
                self._read_call(node, path)

    def _add_pattern(self, node: ast.JoinedStr) -> None:
        parts = [
            re.escape(str(part.value)) if isinstance(part, ast.Constant) else "(.+)" for part in node.values
        ]
        if "\\." in "".join(parts):
            self.patterns.add("".join(parts))

    def _read_call(self, node: ast.Call, path: Path) -> None:
        name = node.func.id if isinstance(node.func, ast.Name) else getattr(node.func, "attr", "")
        at = 1 if name in ("sentence", "on_page") else 0  # after the language
        key = node.args[at] if name in _PREFIXES and len(node.args) > at else None
        if isinstance(key, ast.Constant) and isinstance(key.value, str):
            self.named.setdefault(_PREFIXES[name] + key.value, f"{path.relative_to(_ROOT)}:{node.lineno}")

    def _read_template(self, path: Path) -> None:
        text = path.read_text(encoding="utf-8")
        self.literals.update(_IN_TEMPLATE.findall(text))
        self.patterns.update(re.escape(start) + "(.+)" for start in _JOINED.findall(text))
        for key in _SAY_CALL.findall(text):
            self.named.setdefault(f"page.{key}", str(path.relative_to(_ROOT)))


def pairs() -> Iterator[str]:
    """Compare the languages of the sentences that stand in the source, because they are built from its values."""
    for path in sorted(_ROOT.rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        for node in ast.walk(ast.parse(text)) if "Text(" in text else ():
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "Text":
                said = [
                    _values(keyword.value) for keyword in node.keywords if isinstance(keyword.value, _WRITTEN)
                ]
                if len(said) == len(LANGUAGES) and said[0] != said[1]:
                    yield f"{path.relative_to(_ROOT)}:{node.lineno}: the languages name other values"


def _values(node: ast.expr) -> frozenset[str]:
    """Return the names of what an f-string, or a text to be formatted, puts in."""
    put = {child.id for child in ast.walk(node) if isinstance(child, ast.Name)} - set(LANGUAGES)
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        put |= set(re.findall(r"\{(\w*)\}", node.value))
    return frozenset(put)


def main() -> int:
    """Print what is wrong; return 1 if anything is."""
    all_faults = faults()
    for line in all_faults:
        print(line)  # noqa: T201 - a tool of the developers
    return 1 if all_faults else 0


if __name__ == "__main__":
    sys.exit(main())
