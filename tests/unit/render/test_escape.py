"""Nothing a student writes may control the terminal, the page or the reader's eye."""

import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.render.escape import visible, visible_html, visible_line

ANY_TEXT = st.text(st.characters())
REORDERING = {"LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI"}
BLANK_LETTERS = "\u115f\u1160\u3164\uffa0\u17b4\u17b5"


@pytest.mark.parametrize(
    ("raw", "shown"),
    [
        ("plain text", "plain text"),
        ("中文,标点。±°→", "中文,标点。±°→"),
        ("\x1b[31mred\x1b[0m", "\\x1b[31mred\\x1b[0m"),
        ("abc\u202edcba", "abc\\u202edcba"),
        ("a\u2066b\u2069", "a\\u2066b\\u2069"),
        ("zero\u200bwidth\ufeff", "zero\\u200bwidth\\ufeff"),
        ("bell\x07 back\x08 null\x00", "bell\\x07 back\\x08 null\\x00"),
        ("\x9b31m", "\\x9b31m"),
        ("\r overwritten", "\\x0d overwritten"),
        ("two\r\nlines\n", "two\nlines\n"),
        ("\tindented", "    indented"),
        ("\ud800", "\\ud800"),
        ("\U000e0041tag", "\\U000e0041tag"),
        ("\u3164blank letter", "\\u3164blank letter"),
        ("[bold]markup[/bold]", "[bold]markup[/bold]"),
        ("🎉", "🎉"),
    ],
)
def test_what_is_shown(raw: str, shown: str) -> None:
    assert visible(raw) == shown


@given(ANY_TEXT)
def test_nothing_hidden_is_left(text: str) -> None:
    for character in visible(text):
        assert character == "\n" or unicodedata.category(character)[0] not in "C"
        assert unicodedata.category(character) not in {"Zl", "Zp"}
        assert unicodedata.bidirectional(character) not in REORDERING


@given(ANY_TEXT)
def test_twice_is_once(text: str) -> None:
    assert visible(visible(text)) == visible(text)


@given(ANY_TEXT)
def test_the_result_can_be_written_as_utf8(text: str) -> None:
    visible(text).encode()


@given(st.text(st.characters(categories=["L", "N", "P"], exclude_characters=BLANK_LETTERS)))
def test_what_can_be_seen_is_unchanged(text: str) -> None:
    assert visible(text) == text


@given(ANY_TEXT, st.integers(1, 40))
def test_a_line_is_one_line_and_bounded(text: str, limit: int) -> None:
    line = visible_line(text, limit)
    assert "\n" not in line
    assert len(line) <= limit


@given(ANY_TEXT)
def test_html_has_no_markup(text: str) -> None:
    assert not set(visible_html(text)) & set("<>\"'")


def test_html_keeps_the_reading() -> None:
    assert (
        visible_html("<script>alert('&')</script>") == "&lt;script&gt;alert(&#x27;&amp;&#x27;)&lt;/script&gt;"
    )
