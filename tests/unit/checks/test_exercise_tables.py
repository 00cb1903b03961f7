"""The guide names every check, measure, option, step and expectation, as the code has them."""

import pytest

from grader.contracts.text import Language
from tools.exercise_tables import PAGES, with_tables


@pytest.mark.parametrize("language", ["en", "zh"])
def test_the_tables_are_those_of_the_code(language: Language) -> None:
    page = PAGES[language].read_text(encoding="utf-8")
    assert page == with_tables(page, language), "run python tools/exercise_tables.py"
