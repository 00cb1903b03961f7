"""The messages are complete, and whoever reads gettext's files reads the same as the grader."""

from collections.abc import Mapping
from pathlib import Path

import pytest
from babel.messages.pofile import read_po

from grader.checks.kinds import KINDS
from grader.contracts.text import LANGUAGES, Language, Text
from grader.messages import MissingMessageError, check, entries, file_of, join, outline, say, sentence


def measure_ids() -> set[str]:
    """Every id that follows from the table of checks."""
    ids = {f"{kind}.remarks" for kind in KINDS}
    for kind, one in KINDS.items():
        for name, measure in one.measures.items():
            seen = ("yes", "no") if measure.form == "flag" else ("seen",)
            ids |= {f"{measure.of or kind}.{name}.{part}" for part in ("name", "hint", *seen)}
    return ids


def test_nothing_is_missing_unused_or_different() -> None:
    assert check.faults() == []


@pytest.mark.parametrize("name", check.FILES)
@pytest.mark.parametrize("language", LANGUAGES)
def test_other_tools_read_the_same(language: Language, name: str) -> None:
    with file_of(language, name).open("rb") as file:
        read = {str(each.id): str(each.string) for each in read_po(file, abort_invalid=True) if each.id}
    assert read == entries(language, name)
    assert len(read) > 200


def test_every_measure_has_its_sentences() -> None:
    assert measure_ids() <= set(entries("en", "grader"))


@pytest.mark.parametrize(
    ("changed", "fault"),
    [
        ({"page.upload.send": None}, "en: page.upload.send is missing"),
        ({"page.upload.send": " "}, "en: page.upload.send is missing"),
        ({"page.upload.send": "上传"}, "en: page.upload.send has Chinese characters"),
        ({"page.points": "points"}, "page.points has other fields in one language: zh: ['points']; en: []"),
        ({"page.rules.late.never": "-"}, "page.rules.late.never is not used"),
        ({"mistake.too_tired": "-"}, "mistake.too_tired is not used"),
        ({"mistake.no_turns": None}, "no message mistake.no_turns"),
        ({"word.gap": None}, "no message word.gap"),
        ({"page.nav.people": None}, "no message page.nav.people"),
    ],
)
def test_each_fault_is_found(
    monkeypatch: pytest.MonkeyPatch, changed: dict[str, str | None], fault: str
) -> None:
    (key,) = changed

    def with_the_fault(language: Language, name: str) -> Mapping[str, str]:
        texts = dict(entries(language, name))
        if language == "en" and (key in texts or name == ("pages" if key.startswith("page.") else "grader")):
            texts |= {key: changed[key] or ""}
            texts = {one: text for one, text in texts.items() if text}
        return texts

    monkeypatch.setattr(check, "entries", with_the_fault)
    assert any(line.endswith(fault) for line in (*check.differences(), *check.uses()))


def test_an_entry_that_is_given_twice_or_over_two_lines_is_found(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    text = file_of("en", "pages").read_text(encoding="utf-8")
    copy = tmp_path / "pages.po"
    text += '\nmsgid "page.points"\nmsgstr "-"\n\nmsgid "page.skip"\nmsgstr ""\n"no"\n'
    copy.write_text(text, encoding="utf-8")
    monkeypatch.setattr(
        check, "file_of", lambda *names: copy if names == ("en", "pages") else file_of(*names)
    )
    faults = list(check.differences())
    assert "en: page.points stands there 2 times" in faults
    assert "en: page.skip stands there 2 times" in faults


def test_a_value_in_two_languages_is_inserted_in_each() -> None:
    said = say("mistake.wall_hit", time="5 s", wall=Text(zh="右", en="right"))
    assert "右边的墙" in said.zh
    assert "the right wall" in said.en


def test_values_are_not_templates() -> None:
    assert "{rate}" in sentence("en", "mistake.unknown_name", line=3, problem="{rate}")


def test_an_unknown_id_is_refused() -> None:
    with pytest.raises(MissingMessageError):
        say("no.such.message")
    assert outline("en", "no.such.message") is None


def test_join() -> None:
    parts = [Text(zh="边数", en="sides"), Text(zh="转角", en="angles")]
    assert join(parts, Text(zh="、", en=", ")) == Text(zh="边数、转角", en="sides, angles")
