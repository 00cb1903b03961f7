"""Changes of a line that Python does not take. Such a script has no tree, so they are changes of its text."""

import keyword
import re
from collections.abc import Iterator, Mapping
from itertools import accumulate, takewhile
from typing import Final

from grader.contracts.names import STATEMENTS, near_name
from grader.contracts.outcome import StudentError
from grader.edits.situation import Proposal
from grader.edits.tree import Edit

_WIDE: Final = str.maketrans(
    "（），：；“”‘’＝＋－＊／．＜＞！［］｛｝　\u00a0\u2212\u2013\u2014×÷", "(),:;\"\"''=+-*/.<>![]{}  ---*/"
)
_REWRITTEN: Final = (
    (r"\belse[ \t]+if\b|\belseif\b|\belsif\b", "elif"),
    (r"&&", " and "),
    (r"\|\|", " or "),
    (r"!(?=[\w(])", "not "),
    (r"([\w.]+)\+\+", r"\1 += 1"),
    (r"([\w.]+)--", r"\1 -= 1"),
    (r"=([<>])(?!=)", r"\1="),
    (r"//[ \t]*(?=[^\d\s])", "# "),
    (r"/\*(.*?)\*/", r"# \1"),
    (r"(\d)[ \t]*(m/s|rad/s|rad|cm|m|s|f|米|秒|度|弧度)\b", r"\1"),
    (r"\b(int|float|double|bool|string|var|let|const|auto)[ \t]+(?=[A-Za-z_])", ""),
    (r"^([ \t]*)print[ \t]+([^(\n].*)$", r"\1print(\2)"),
    (r"^([ \t]*(?:if|elif|while)\b[^=\n]*[^=!<>\n])=([^=])", r"\1==\2"),
    (r"^([ \t]*(?:from|import)[ \t]+[\w.]*)-", r"\1_"),
    (r"^([ \t]*(?:class|def)[ \t]+\w+)[ -](?=\w)", r"\1_"),
    (r"^([ \t]*def[ \t]+\w+)[ \t]*:", r"\1():"),
    (r"^([ \t]*)(class|def)(?=[A-Z_a-z]\w*\()", r"\1\2 "),
    (r"^([ \t]*)(\w+[ \t]*\([ \t]*self\b.*:)", r"\1def \2"),
    (r"^([ \t]*except)[ \t]+(\w+),[ \t]*(\w+)", r"\1 (\2, \3)"),
    (r"^([ \t]*)else[ \t]+[^:\n]+:", r"\1else:"),
    (r"^([ \t]*for[ \t]+\w+)[ \t]+(?=range)", r"\1 in "),
    (r"\bself[ \t]+(?=[A-Za-z_]\w*[ \t]*[(=])", "self."),
    (r"\)[ \t]*(?=[A-Za-z_]\w*\()", ")."),
    (r"\)[ \t]*(?=[A-Za-z_]\w*\()", "), "),
    (r"([(,][ \t]*)(/\w[\w/]*)(?=[ \t]*[,)])", r"\1'\2'"),
    (r"\brange\[([^\]]*)\]", r"range(\1)"),
    (r"(?<=\w)::(?=\w)", "."),
    (r"^([ \t]*)elif[ \t]*:", r"\1else:"),
    (r"^([ \t]*)elif\b(?=.*:)", r"\1if"),
    (r"\.(?=\w+[ \t]*=)", "_"),
    (r"^[ \t]*```\w*$", ""),
    (r"^[ \t]*(>>>|\$|%|!|\.\.\.|In \[\d*\]:)[ \t]?", ""),
    (r"^\d+[.:|)]?([ \t]{2}|$)", ""),
    (r"^\d+[.:|)]?([ \t]|$)", ""),
    (r"\}[ \t]*$|\{[ \t]*$|;[ \t]*$", ""),
    (r"\([ \t]*(\w+)\.(\w+)[ \t]*=", r"(\2="),
)
"""What people write as in other languages, on paper or in a terminal, and what Python has instead."""
_CLOSERS: Final = (
    (r"string literal|quote", ("'", '"', "')", '")', "'))", '"""', "'''")),
    (r"never closed|unmatched|does not match|comma", (")", "))", "]", "}", "):")),
    (r"expected ':'|invalid syntax", (":", "):", ",", ")")),
)
"""What may be missing at the end of a line, by what Python says of it."""
_LINES_BACK: Final = 2
_NO_COMMA: Final = re.compile(
    r"(?!(?:and|async|await|else|for|if|in|is|lambda|not|or)\b)(\b[\w.]+|[)\]'\"])[ \t]+"
    r"(?!(?:and|else|for|if|in|is|not|or)\b)(?=['\"\w])"
)
"""Between two words, neither of which stands between others."""
_BY_FIELDS: Final = re.compile(r"([ \t]*)([\w.]+)[ \t]*=[ \t]*(\w+)\((.*\w\.\w+[ \t]*=[^=].*)\)[ \t]*")
_PROGRAM: Final = re.compile(
    r"(import|from|def|class|if|for|while|try|with)\b|[ \t]+\S|[@#\"'\])}]|[\w.]+[ \t]*[(=]"
)
"""How a line of a program begins, unlike one of a terminal or of a conversation."""


def syntax_changes(text: str, error: StudentError) -> Iterator[Proposal]:
    """Yield changes of the line that Python rejects, of those just above, and of all lines at once."""
    lines = text.split("\n")
    for back in range(_LINES_BACK + 1):
        number = (error.line or 0) - back
        if 1 <= number <= len(lines):
            for place, new in enumerate(dict.fromkeys(_ways(lines, number, error.message))):
                if new != lines[number - 1]:
                    yield _proposal(lines, {number: new}, 0.2 + back + 0.02 * place)
    if "indented block" in error.message and error.line is not None and error.line <= len(lines):
        yield _proposal(lines, _block(lines, error.line), 0.15)
    for place, whole in enumerate(_wholes(lines, error)):
        yield _proposal(lines, whole, 0.1 + 0.01 * place)
    for pattern, new in ((None, ""), *_REWRITTEN):
        changed = {
            number: better
            for number, line in enumerate(lines, 1)
            if (better := line.translate(_WIDE) if pattern is None else re.sub(pattern, new, line)) != line
        }
        if error.line in changed and len(changed) > 1:
            most = len(changed) > len(lines) / 3  # all of it was pasted from elsewhere
            yield _proposal(lines, changed, 0.1 if most else 0.25 if pattern is None else 0.9)


def _proposal(lines: list[str], changed: Mapping[int, str | None], cost: float) -> Proposal:
    """Return the proposal of other texts for lines; None for those that go."""
    starts = [*accumulate((len(line) + 1 for line in lines), initial=0)]
    starts[-1] -= 1
    edits = tuple(
        Edit(starts[number - 1], starts[number - 1] + len(lines[number - 1]), new)
        if new is not None
        else Edit(starts[number - 1], starts[number], "")
        for number, new in changed.items()
    )
    number, new = max(changed.items(), key=lambda one: bool((one[1] or lines[one[0] - 1]).strip()))
    old, new = lines[number - 1], new or ""
    if "except" not in new:
        new = re.sub(r"\n[ \t]*", "; ", new)
    return Proposal(
        "syntax", cost, edits, {"line": number, "old": old.strip(), "new": new.strip()} | _slip(old, new)
    )


def _slip(old: str, new: str) -> dict[str, object]:
    """Return what names a single slip better than the two texts of its line: `sentence`, and its values."""
    if not new:
        return {"sentence": "syntax_pasted"}
    if new.endswith(f'"""; {old.lstrip()}'):
        return {"sentence": "syntax_docstring"}
    if new.strip() == f"{old.strip()}:":
        return {"sentence": "syntax_colon"}
    wide = {one for one in old if _WIDE.get(ord(one)) and one.isprintable() and one.strip()}
    if new == old.translate(_WIDE) and len(wide) == 1:
        (character,) = wide
        return {"sentence": "syntax_wide", "wide": character, "narrow": character.translate(_WIDE)}
    return {}


def _ways(lines: list[str], number: int, message: str) -> Iterator[str]:
    """Yield how a line may have been meant, the likeliest first; last of all as a comment."""
    line = lines[number - 1]
    code, mark, comment = line.partition("#")
    code, rest = code.rstrip(), f"  {mark}{comment}" if mark else ""
    if line.translate(_WIDE) != line:
        yield line.translate(_WIDE)
    if "indent" in message or "tab" in message.lower():
        yield from _indented(lines, number)
    if "':'" in message:
        yield f"{code}:{rest}"
    yield from _near_words(line)
    if "(" in code:
        head, bracket, given = code.partition("(")
        yield head + bracket + _NO_COMMA.sub(r"\1, ", given) + rest
    yield from _by_fields(code)
    for pattern, new in _REWRITTEN:
        if (better := re.sub(pattern, new, code)) != code:
            yield better + rest
    yield from _endings(line, message)
    yield from _indented(lines, number)
    yield f"{line[: len(line) - len(line.lstrip())]}# {line.strip()}"


def _endings(line: str, message: str) -> Iterator[str]:
    """Yield a line with another end: what Python misses there, or without its last sign."""
    code, mark, comment = line.partition("#")
    code, rest = code.rstrip(), f"  {mark}{comment}" if mark else ""
    if "'except'" in message:
        depth = max(len(line) - len(line.lstrip()) - 4, 0)
        yield f"{line}\n{' ' * depth}except KeyboardInterrupt:\n{' ' * depth}    pass"
    for sign, closers in _CLOSERS:
        for closer in closers if re.search(sign, message) else ():
            if not code.endswith(":"):
                yield f"{code}{closer}{rest}"
            if code.endswith((":", ")")) and closer in (")", "'", '"'):
                yield f"{code[:-1]}{closer}{code[-1]}{rest}"
    if code.endswith((")", "]", "}", ",", "'", '"')):
        yield code[:-1] + rest


def _by_fields(code: str) -> Iterator[str]:
    """Yield a message and its fields one by one for a call that is given them with dots."""
    match = _BY_FIELDS.fullmatch(code)
    if match is not None:
        depth, name, kind, given = match.groups()
        fields = (f"{depth}{name}.{one.strip()}" for one in given.split(","))
        yield "\n".join(
            (f"{depth}{name} = {kind}()", *(re.sub("[ \t]*=[ \t]*", " = ", one) for one in fields))
        )


def _wholes(lines: list[str], error: StudentError) -> Iterator[dict[int, str | None]]:
    """Yield the script without what was pasted around it, and with a docstring that ends before the program."""
    first = low = high = error.line or 1
    fences = [number for number, line in enumerate(lines, 1) if line.startswith("```")]
    if len(fences) > 1:
        yield {number: None for number in range(1, len(lines) + 1) if not fences[0] < number < fences[-1]}
    while low > 1 and not _PROGRAM.match(lines[low - 2]):
        low -= 1
    while high < len(lines) and not _PROGRAM.match(lines[high]):
        high += 1
    pasted = range(low, high + 1)
    if len(pasted) < len(lines) and not _PROGRAM.match(lines[first - 1]) and (low == 1 or high == len(lines)):
        yield dict.fromkeys(pasted)
    if "triple-quoted" in error.message:
        for number in range(first + 1, len(lines) + 1):
            if re.match(r"[ \t]*(import|from|def|class|self\.|super\()", lines[number - 1]):
                depth = len(lines[first - 1]) - len(lines[first - 1].lstrip())
                yield {number: f'{" " * depth}"""\n{lines[number - 1]}'}
                return


def _near_words(line: str) -> Iterator[str]:
    """Yield the line with the word of Python's that its first one nearly is, and with a name that may be one."""
    match = re.match(r"([ \t]*)([A-Za-z]+)\b", line)
    if match is None:
        return
    near = near_name(match[2], STATEMENTS) if match[2] not in STATEMENTS else None
    if near is not None:
        yield match[1] + near + line[match.end() :]
    if keyword.iskeyword(match[2]) and re.match(r"[ \t]*=(?!=)", line[match.end() :]):
        yield f"{match[1]}{match[2]}_{line[match.end() :]}"


def _indented(lines: list[str], number: int) -> Iterator[str]:
    """Yield a line as far in as those around it, or as the block that it begins."""
    line = lines[number - 1].strip()
    above = next((one for one in reversed(lines[: number - 1]) if one.strip()), "")
    below = next((one for one in lines[number:] if one.strip()), "")
    depths = [len(one.expandtabs(4)) - len(one.expandtabs(4).lstrip()) for one in (above, below)]
    if above.rstrip().endswith(":"):
        yield " " * (depths[0] + 4) + line
        yield " " * (depths[0] + 4) + "pass\n" + lines[number - 1]
    for depth in (*depths, depths[0] - 4, depths[0] + 4):
        if depth >= 0:
            yield " " * depth + line


def _block(lines: list[str], number: int) -> dict[int, str]:
    """Return a line and those behind it that are as far in, up to the next empty one, all one step further in."""
    first = lines[number - 1]
    depth = len(first) - len(first.lstrip())
    block = takewhile(
        lambda line: line.strip() and len(line) - len(line.lstrip()) >= depth, lines[number - 1 :]
    )
    return {number + place: "    " + line for place, line in enumerate(block)}
