"""Wrong attempts that are written as a change of another script, and how they are carried out."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from grader.catalog.misfits import MisfitError
from grader.contracts.text import Text

MOST_ATTEMPTS: Final = 200
MOST_BYTES: Final = 2 * 1024 * 1024
"""Of all changed scripts together: as much as the files of an uploaded assignment may have."""

NOT_A_CHANGE: Final = Text(
    zh='写成 {"原来的文字": "新的文字"}，两边都加引号；几行一起改就写补丁：一行 @@，下面每行以空格、- 或 + 开头',
    en='write {"old text": "new text"}, both in quotes; for several lines write a patch: a line @@, and below '
    "it lines that begin with a space, - or +",
)
NEEDS_CHANGE: Final = Text(
    zh="只有写了 change 才能有：加上 change，或删掉它", en="it belongs to a change; add change or remove it"
)
NO_CHANGE_OF_PACKAGE: Final = Text(
    zh="功能包不能这样写：在 wrong/ 里放一个文件夹",
    en="a package cannot be written so; put its folder into wrong/",
)
LARGE: Final = Text(
    zh=f"改出来的脚本一共超过 {MOST_BYTES // 1024} KiB：缩短",
    en=f"the changed scripts have more than {MOST_BYTES // 1024} KiB together; shorten them",
)
_NO_HUNK: Final = Text(zh="补丁从一行 @@ 开始：加上", en="a patch begins with a line @@; add it")
_NO_PLACE: Final = Text(
    zh="这处补丁没有说改哪里：加上一行原有的代码，以空格或 - 开头",
    en="a place of the patch has new lines only; add a line that stands there, beginning with a space or -",
)
_OVERLAP: Final = Text(zh="两处改动重叠：合成一处", en="two of the changes overlap; write them as one")
_DOCSTRING: Final = re.compile(r"\A(\"\"\"|''')(.*?)\1(\n*)", re.DOTALL)
_NO_DOCSTRING: Final = Text(
    zh='被改的脚本开头没有 """…"""：加上，或删掉 about',
    en='what is changed does not begin with """…"""; add that to it or remove about',
)
_SHOWN: Final = 60


@dataclass(frozen=True, slots=True)
class Replacement:
    """A text and what stands in its place. Of a patch: whole lines."""

    old: str
    new: str
    whole_lines: bool = False

    def span(self, base: str) -> tuple[int, int]:
        """Return where `base` has the old text. Raises MisfitError: nowhere, or in several places."""
        line_start = "(?m:^)" if self.whole_lines else ""
        starts = [match.start() for match in re.finditer(f"{line_start}(?={re.escape(self.old)})", base)]
        if len(starts) != 1:
            raise MisfitError(_not_once(self.old, len(starts)), "change", self.old)
        return starts[0], starts[0] + len(self.old)


def edits_of(change: object) -> tuple[Replacement, ...]:
    """Return what the field ``change`` says: new texts by old ones, or a patch.

    Raises MisfitError: it is neither, or changes nothing.
    """
    if isinstance(change, str):
        edits = tuple(_hunks(change.splitlines()))
    elif isinstance(change, dict) and all(isinstance(text, str) for pair in change.items() for text in pair):
        edits = tuple(Replacement(old, new) for old, new in change.items())
    else:
        raise MisfitError(NOT_A_CHANGE)
    if not edits or not all(edit.old for edit in edits):
        raise MisfitError(NOT_A_CHANGE)
    for edit in edits:
        if edit.old == edit.new:
            raise MisfitError(_changes_nothing(edit.old))
    return edits


def _hunks(lines: list[str]) -> Iterator[Replacement]:
    """Read the lines of a patch as ``diff -u`` writes it; names of files and numbers of lines are passed over."""
    starts = [number for number, line in enumerate(lines) if line.startswith("@@")]
    if not starts or not all(line.startswith(("--- ", "+++ ")) for line in lines[: starts[0]]):
        raise MisfitError(_NO_HUNK)
    for start, end in zip(starts, [*starts[1:], len(lines)], strict=True):
        hunk = [line or " " for line in lines[start + 1 : end]]  # editors drop the space of an empty line
        if strange := [line for line in hunk if line[0] not in " -+"]:
            raise MisfitError(_no_line_of_a_patch(strange[0]))
        old, new = ("".join(f"{line[1:]}\n" for line in hunk if line[0] in kept) for kept in (" -", " +"))
        if not old:
            raise MisfitError(_NO_PLACE)
        yield Replacement(old, new, whole_lines=True)


def changed(base: str, edits: tuple[Replacement, ...], about: str | None = None) -> str:
    """Return `base` with the edits, each at its one place in `base`.

    `about` takes the place of the docstring at its beginning; an empty one takes the docstring away.

    Raises:
        MisfitError: an old text is not there exactly once, two edits overlap, or there is no docstring to replace.
    """
    places = [(*edit.span(base), edit.new) for edit in edits]
    if about is not None:
        docstring = _DOCSTRING.match(base)
        if docstring is None:
            raise MisfitError(_NO_DOCSTRING, "about")
        quotes, _, lines = docstring.groups()
        places.append((0, docstring.end(), f"{quotes}{about}{quotes}{lines}" if about else ""))
    text, end = "", 0
    for start, stop, new in sorted(places):
        if start < end:
            raise MisfitError(_OVERLAP, "change")
        text += base[end:start] + new
        end = stop
    return text + base[end:]


def _not_once(old: str, times: int) -> Text:
    if times:
        return Text(
            zh=f"{_shown(old)} 出现了 {times} 次：多写一些，让它只出现一次",
            en=f"{_shown(old)} is there {times} times; write more of it, so that it is there once",
        )
    return Text(
        zh=f"被改的脚本里没有 {_shown(old)}：照原文抄，空格也要一样",
        en=f"what is changed does not have {_shown(old)}; copy it as it stands, with its spaces",
    )


def _changes_nothing(old: str) -> Text:
    return Text(
        zh=f"{_shown(old)} 改了以后还是一样：写上不同的文字",
        en=f"{_shown(old)} stays as it is; write another text for it",
    )


def _no_line_of_a_patch(line: str) -> Text:
    return Text(
        zh=f"补丁里的 {_shown(line)} 不以空格、- 或 + 开头：补上",
        en=f"the patch's line {_shown(line)} does not begin with a space, - or +; add it",
    )


def _shown(text: str) -> str:
    return repr(text if len(text) <= _SHOWN else f"{text[: _SHOWN - 1]}…")
