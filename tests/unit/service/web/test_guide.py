"""The guide for students as a page."""

import csv
import io
import re
import zipfile

import httpx
import pytest

from grader.service.web.guide import guide


@pytest.mark.parametrize("language", ["zh", "en"])
def test_the_guide_is_html_without_links_that_lead_nowhere(language: str) -> None:
    title, content = guide(language)
    assert title
    assert content.count("<tr>") == 21
    assert content.count("<h2>") >= 6
    assert "<code>grader check square_mover.py" in content
    assert re.findall(r'href="(?!https?:)', content) == []


def test_the_page_says_where_this_version_can_be_installed_from(client: httpx.Client) -> None:
    guide_page = client.get("/guide").text
    (address, *others) = set(re.findall(r"(?:pipx|uv tool) install (http\S+)", guide_page))
    assert not others
    assert "ADDRESS" not in guide_page

    answer = client.get(address)

    assert answer.status_code == 200
    with zipfile.ZipFile(io.BytesIO(answer.content)) as archive:
        names = set(archive.namelist())
        record = archive.read(next(name for name in names if name.endswith(".dist-info/RECORD"))).decode()
    assert {"grader/__main__.py", "grader/assignments/square/assignment.yaml"} <= names
    assert {row[0] for row in csv.reader(record.splitlines())} == names


def test_another_version_is_not_there(client: httpx.Client) -> None:
    assert client.get("/download/grader-0.0.0-py3-none-any.whl").status_code == 404
