"""Lines of sentences in the terminal."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.cells import cell_len

from grader.render.prose import Prose, breaks
from grader.render.terminal import console


def lines(text: str, width: int) -> list[str]:
    return [line.plain for line in Prose(text).wrap(console(width=width), width)]


@pytest.mark.parametrize(
    ("text", "width", "wanted"),
    [
        ("相差最大的是 57.3°。", 18, ["相差最大的是", "57.3°。"]),
        ("先让“转角”得分才有意义。", 22, ["先让“转角”得分才有意", "义。"]),
        ("各角为 57.3°、57.3°；与", 15, ["各角为 57.3°、", "57.3°；与"]),
        ("是周长 8 m 的 0.7 %。", 18, ["是周长 8 m 的", "0.7 %。"]),
        ("距离 2 m、2 m、2 m", 15, ["距离 2 m、2 m、", "2 m"]),
        ("检查（expected ':'）括号", 17, ["检查（expected", "':'）括号"]),
        ("去（见", 4, ["去", "（见"]),
        ("The quick brown fox", 10, ["The quick", "brown fox"]),
        ("averylongword here", 6, ["averyl", "ongwor", "d here"]),
        ("one\n\ntwo", 9, ["one", "", "two"]),
        ("", 9, [""]),
    ],
)
def test_lines_break_where_they_may(text: str, width: int, wanted: list[str]) -> None:
    assert lines(text, width) == wanted


@given(st.text(alphabet="ab 中文，。（）%57.", max_size=60), st.integers(2, 20))
def test_nothing_is_lost_and_nothing_too_wide(text: str, width: int) -> None:
    places = list(breaks(text, width))
    assert places == sorted(set(places))
    assert "".join(lines(text, width)).replace(" ", "") == text.replace(" ", "")
    assert all(cell_len(line.rstrip()) <= width for line in lines(text, width))
