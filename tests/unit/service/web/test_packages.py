"""A package on its pages: all its files as one listing, errors at their lines there, and a download."""

from collections.abc import Callable

from grader.formats.packages.bundle import bundled, line_in_text
from grader.service.web.source import source_view
from tests.fakes.packages import NAME, package_files, zipped
from tests.unit.service.web.conftest import Browser

KEPT = bundled(zipped(package_files()))
HELPER = f"{NAME}/{NAME}/helper.py"


def test_a_package_is_shown_file_by_file(instructor: Browser, put: Callable[..., str]) -> None:
    url = put(KEPT, name="my_turtle.zip")
    page = instructor.client.get(url).text
    assert f"# ===== {HELPER} =====" in page
    assert "def main():" in page
    assert f'<li id="L{line_in_text(KEPT, HELPER, 1)}"' in page
    download = instructor.client.get(f"{url}/source")
    assert download.content == KEPT
    assert "my_turtle.zip" in download.headers["content-disposition"]


def test_an_error_is_shown_at_its_line_of_the_listing() -> None:
    at = line_in_text(KEPT, HELPER, 5)
    view = source_view(KEPT, {at: ["AttributeError: x"]})
    marked = [line for line in view.lines if line.errors]
    assert [(line.number, line.text.strip()) for line in marked] == [(at, "msg = Twist()")]
