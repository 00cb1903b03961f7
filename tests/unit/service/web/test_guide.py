"""The guide for students as a page."""

import csv
import io
import re
import zipfile
from urllib.parse import unquote

import httpx
import pytest

from grader.service.web.guide import guide
from tests.unit.service.web.conftest import Browser


@pytest.mark.parametrize("language", ["zh", "en"])
def test_the_guide_is_html_without_links_that_lead_nowhere(language: str) -> None:
    title, content = guide("student", language)
    assert title
    assert content.count("<tr>") == 21
    assert content.count("<h2 id=") >= 6
    assert "<code>grader check square_mover.py" in content
    assert re.findall(r'href="(?!https?:)', content) == []


@pytest.mark.parametrize("language", ["zh", "en"])
@pytest.mark.parametrize("name", ["instructor", "exercises"])
def test_the_guides_for_teachers_lead_to_each_other(name: str, language: str) -> None:
    title, content = guide(name, language)
    assert title
    targets = set(re.findall(r'href="(?!https?:)([^"]*)"', content))
    anchors = {f"#{one}" for one in re.findall(r' id="([^"]*)"', content)}
    pages = {one.partition("#")[0] for one in targets if not one.startswith("#")}
    assert pages <= {"/guide", "/class/guide", "/class/guide/exercises"}
    assert {unquote(one) for one in targets if one.startswith("#")} <= anchors
    assert len(anchors) > 5


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


def test_a_template_is_a_folder_that_can_be_uploaded(client: httpx.Client, tokens: dict[str, str]) -> None:
    wang = Browser(client)
    wang.enter(token=tokens["wang"])
    assert 'href="/class/guide/exercises"' in wang.get("/class/own").text
    for like in ("", "square"):
        answer = wang.get(f"/class/own/template.zip?id=my_walk&like={like}")
        with zipfile.ZipFile(io.BytesIO(answer.content)) as archive:
            spec = archive.read("my_walk/assignment.yaml").decode()
            assert {"my_walk/solution.py", "my_walk/starter.py"} <= set(archive.namelist())
        assert "id: my_walk" in spec
        files = {"file": ("my_walk.zip", answer.content, "application/zip")}
        taken = wang.post("/class/own", {}, files=files, page="/class/own")
        assert taken.headers.get("Location") == "/class/own?done=uploaded", taken.text
    assert wang.get("/class/own/template.zip?id=My-Walk").status_code == 422
    assert wang.get("/class/own/template.zip?id=a&like=nothing").status_code == 404
    assert 'http-equiv="refresh"' in wang.get("/class/own").text
