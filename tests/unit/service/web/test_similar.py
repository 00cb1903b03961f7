"""Similar scripts on their pages: who is listed, and the shared lines side by side."""

import re
from collections.abc import Callable

import pytest

from tests.unit.service.web.conftest import Browser
from tests.unit.similarity.students import own_code, renamed

OWN, OTHER = (f"class Own:{own_code(i)}" for i in (1, 2))
LINK = re.compile(r'href="(/class/similar/square/pair\?[^"]+)"')


@pytest.fixture
def copied(put: Callable[..., str]) -> tuple[str, str]:
    """Addresses of two similar scripts, beside one of somebody else's."""
    put(OTHER.encode(), student="unlike-them")
    return put(OWN.encode(), student="s1"), put(renamed(OWN).encode(), student="<s2>")


@pytest.mark.parametrize(("language", "title"), [("zh", "相似的程序"), ("en", "Similar scripts")])
def test_the_list_leads_to_both_scripts(
    instructor: Browser, copied: tuple[str, str], language: str, title: str
) -> None:
    assert title in instructor.get(f"/class/assignments/square?lang={language}").text
    listed = instructor.get(f"/class/similar/square?lang={language}").text
    assert title in listed
    assert listed.count("<tbody>") == 1
    (link,) = LINK.findall(listed)
    for address in copied:
        assert f'href="{address}"' in listed
    assert "unlike-them" not in listed
    page = instructor.get(link.replace("&amp;", "&")).text
    assert page.count('class="alike"') > 10
    assert 'id="A-1" href="#B-1"' in page
    assert 'id="B-1" href="#A-1"' in page
    assert "&lt;s2&gt;" in page
    assert "page.similar" not in listed + page


def test_equal_commands_stand_below(instructor: Browser, put: Callable[..., str]) -> None:
    listed = instructor.get("/class/similar/square?lang=en").text
    assert listed.count("None.") == 2
    assert "Same commands, different text" in listed


def test_a_pair_that_is_not_similar_is_not_shown(instructor: Browser, copied: tuple[str, str]) -> None:
    first, _ = (one.rpartition("/")[2] for one in copied)
    assert instructor.get(f"/class/similar/square/pair?first={first}&second={first}").status_code == 404
    assert instructor.get("/class/similar/none").status_code == 404
    assert "文字题不比较" in instructor.get("/class/similar/theory_publisher_timer?lang=zh").text
