"""The shipped font holds what plots show, under its own name and with its licence."""

from pathlib import Path

import matplotlib
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.ft2font import FT2Font

import grader.render
from grader.messages import entries
from grader.render.typeface import FAMILY, clipped, columns, drawable

FONTS = Path(grader.render.__file__).parent / "fonts"
FONT = FONTS / "GraderSansSC-Regular.otf"
FALLBACK = Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf"
GLYPHS = {code for font in (FONT, FALLBACK) for code in FT2Font(str(font)).get_charmap()}


def test_common_chinese_ascii_and_signs_are_there() -> None:
    level_1 = {
        bytes((row, cell)).decode("gb2312", "ignore")
        for row in range(0xB0, 0xD8)
        for cell in range(0xA1, 0xFF)
    }
    wanted = set("".join(level_1)) | set(map(chr, range(0x20, 0x7F))) | set("−±°×·→…—≤≥ω,。:;!?()、“”")
    labels = (text for key, text in entries("zh", "grader").items() if key.startswith("word."))
    wanted |= set("".join(labels)) - {"✗"}
    assert len(wanted) > 3800
    assert not set(map(ord, wanted)) - set(FT2Font(str(FONT)).get_charmap())


def test_the_subset_does_not_pass_for_the_original() -> None:
    font = FT2Font(str(FONT))
    assert font.family_name == FAMILY
    assert "Noto" not in font.postscript_name
    assert FONT.stat().st_size < 1_500_000


def test_the_licence_stands_beside_it() -> None:
    text = (FONTS / "OFL.txt").read_text(encoding="utf-8")
    assert "Copyright 2014-2021 Adobe" in text
    assert "SIL OPEN FONT LICENSE Version 1.1" in text
    assert text.rstrip().endswith("OTHER DEALINGS IN THE FONT SOFTWARE.")


@pytest.mark.parametrize(
    ("raw", "shown"),
    [
        ("🎉 Hello ROS2! 我是第一个Python节点!", "Hello ROS2! 我是第一个Python节点!"),
        ("✓ 直行完成 → ✗", "✓ 直行完成 → ✗"),
        ("❤️ 好", "❤ 好"),
        ("鱻", "□"),
        ("a\nb", "a\\nb"),
        ("\x1b[0m", "\\x1b[0m"),
    ],
)
def test_drawable(raw: str, shown: str) -> None:
    assert drawable(raw) == shown


@given(st.text(st.characters()))
def test_everything_drawable_has_a_glyph(text: str) -> None:
    assert set(map(ord, drawable(text))) <= GLYPHS


@given(st.text(st.sampled_from("ab 中文。")), st.integers(2, 30))
def test_clipped_text_fits(text: str, width: int) -> None:
    assert columns(clipped(text, width)) <= width
    if columns(text) <= width:
        assert clipped(text, width) == text
