"""The guide for students as a page."""

import re

import pytest

from grader.service.web.guide import guide


@pytest.mark.parametrize("language", ["zh", "en"])
def test_the_guide_is_html_without_links_that_lead_nowhere(language: str) -> None:
    title, content = guide(language)
    assert title
    assert content.count("<tr>") == 21
    assert content.count("<h2>") >= 6
    assert "\ngrader check square_mover.py" in content
    assert re.findall(r'href="(?!https?:)', content) == []
