"""Every refusal is a problem document that says what, where and what to do."""

import ast
import json
from collections.abc import Callable
from pathlib import Path
from typing import get_args

import httpx
import pytest
from fastapi import Request

from grader.contracts.errors import InfrastructureError, SandboxError
from grader.contracts.rules import RefusalCode
from grader.service.routes import problems
from grader.service.routes.problems import PROBLEM_TYPES
from grader.use_cases.services import Services
from tests.fakes.refusals import nothing_stored, problem
from tests.fakes.server import TOKEN

ROOT = Path(__file__).resolve().parents[4]
Upload = Callable[..., httpx.Response]


@pytest.mark.parametrize("source", [b"", b" \n\t\n", b"\xef\xbb\xbf", b"\xef\xbb\xbf \n"])
def test_an_empty_file(upload: Upload, services: Services, source: bytes) -> None:
    document = problem(upload(source), 422, "empty")
    assert (document["field"], document["detail"][:2]) == ("file", "文件")
    assert nothing_stored(services)


def test_a_file_in_another_encoding(upload: Upload, services: Services) -> None:
    document = problem(upload("# 第一行\nprint('方')\n".encode("gbk")), 422, "not_utf8")
    assert "第 1 行" in document["detail"]
    assert nothing_stored(services)


def test_a_file_with_nul_bytes(upload: Upload, services: Services) -> None:
    english = upload(b"x = 1\ny = \0\n", headers={"Accept-Language": "en"})
    assert "line 2" in problem(english, 422, "contains_nul")["detail"]
    assert nothing_stored(services)


def test_a_file_that_is_not_python(upload: Upload, services: Services) -> None:
    document = problem(upload(b"x = 1\nprint(def broken(\n"), 422, "syntax_error")
    assert (document["line"], document["column"]) == (2, 11)
    assert document["text"] == "print(def broken("
    assert "never closed" in document["detail"]
    assert "括号" in document["detail"]  # not only what the compiler says
    assert nothing_stored(services)


@pytest.mark.parametrize(
    ("language", "words"),
    [("zh", "query.offset: 不能大于 1000000。"), ("en", "query.offset: Use 1000000 or less.")],
)
def test_a_wrong_field_is_told_in_the_readers_language(
    client: httpx.Client, language: str, words: str
) -> None:
    headers = {"Authorization": f"Bearer {TOKEN}", "Accept-Language": language}
    response = client.get("/api/v1/judgements/waiting?offset=9999999&every=perhaps", headers=headers)
    document = problem(response, 422, "invalid_request")
    assert words in document["detail"]
    assert len(document["errors"]) == 2


def test_a_syntax_error_cannot_smuggle_control_characters(upload: Upload) -> None:
    document = problem(upload("def broken( # \u202e\x1b[2J\n".encode()), 422, "syntax_error")
    assert document["text"] == "def broken( # \\u202e\\x1b[2J"


@pytest.mark.parametrize("field", ["name", "assignment", "student"])
def test_a_refusal_that_quotes_the_sender_shows_it_escaped(upload: Upload, field: str) -> None:
    evil = "\u202e\u200bsquare\u2066<script>"
    response = upload(**{field: evil})
    document = problem(response, response.status_code, response.json()["code"])
    assert document["status"] in (404, 415, 422)


def test_an_address_that_hides_something_is_quoted_escaped(client: httpx.Client) -> None:
    problem(client.get("/api/v1/assignments/%1B%5B2J%E2%80%AE"), 404, "assignment_not_found")
    problem(client.get("/api/v1/submissions/%1B%5B2J%E2%80%AE"), 404, "submission_not_found")
    problem(client.get("/api/v1/assignments?lang=%1B%5B2J%E2%80%AE"), 422, "invalid_request")


@pytest.mark.parametrize("fault", [InfrastructureError("it died"), SandboxError("no zygote")])
def test_a_failing_preflight_is_no_fault_of_the_file(
    upload: Upload, services: Services, fault: Exception, caplog: pytest.LogCaptureFixture
) -> None:
    services.preflight.fault = fault
    assert upload(b"good").status_code == 202
    assert f"without a look at its syntax: {fault}" in caplog.text


@pytest.mark.parametrize(
    "name", ["square.zip", "square", "square.py.docx", ".py", "square.ipynb", "square.pyc"]
)
def test_a_file_of_another_type(upload: Upload, services: Services, name: str) -> None:
    assert problem(upload(name=name), 415, "wrong_file_type")["field"] == "file"
    assert nothing_stored(services)


def test_an_unknown_assignment(upload: Upload, services: Services) -> None:
    document = problem(upload(assignment="circle"), 422, "unknown_assignment")
    assert document["field"] == "assignment"
    assert document["allowed"] == ["straight", "square"]
    assert nothing_stored(services)


@pytest.mark.parametrize("student", ["", " ", "-x", "a b", "../x", "x" * 65, "a\nb", "<script>", "学号"])
def test_a_bad_student_id(upload: Upload, services: Services, student: str) -> None:
    response = upload(student=student)
    # an empty form field counts as a missing one
    problem(response, 422, "invalid_student" if student else response.json()["code"])
    assert nothing_stored(services)


@pytest.mark.parametrize("student", ["20260123", "a", "li.wei@uni.example", "A_b-9", "x" * 64])
def test_a_good_student_id(upload: Upload, student: str) -> None:
    assert upload(student=student).status_code == 202


def test_missing_fields_are_all_named(client: httpx.Client) -> None:
    response = client.post("/api/v1/submissions", files={"other": ("a.py", b"x")})
    document = problem(response, 422, "invalid_request")
    assert {error["field"] for error in document["errors"]} == {"other", "file", "assignment"}


def test_a_field_of_the_form_that_nobody_reads(upload: Upload, client: httpx.Client) -> None:
    """An instructor's upload for `studnet` would be their own."""
    form = {"assignment": "square", "student": "s1", "studnet": "s2"}
    response = client.post("/api/v1/submissions", files={"file": ("a.py", b"x = 1")}, data=form)
    assert problem(response, 422, "invalid_request")["field"] == "studnet"


@pytest.mark.parametrize(("language", "words"), [("zh", "这不是 JSON。"), ("en", "This is not JSON.")])
def test_a_body_that_is_no_json(client: httpx.Client, language: str, words: str) -> None:
    headers = {
        "Authorization": f"Bearer {TOKEN}",
        "Accept-Language": language,
        "Content-Type": "application/json",
    }
    response = client.put("/api/v1/assignments/square/rules", content=b'{"attempts": 5', headers=headers)
    assert problem(response, 422, "invalid_request")["errors"] == [{"field": "body", "detail": words}]


def test_a_field_where_a_file_belongs(client: httpx.Client) -> None:
    form = {"file": (None, b"text"), "assignment": (None, b"square"), "student": (None, b"s1")}
    assert problem(client.post("/api/v1/submissions", files=form), 422, "invalid_request")["field"] == "file"


def test_too_many_waiting(upload: Upload) -> None:
    for _ in range(3):
        assert upload().status_code == 202
    response = upload()
    problem(response, 429, "too_many_open")
    assert int(response.headers["Retry-After"]) > 0
    assert upload(student="another").status_code == 202


@pytest.mark.parametrize("path", ["", "/report", "/trajectory", "/plot.png"])
def test_an_unknown_submission(client: httpx.Client, path: str) -> None:
    problem(client.get(f"/api/v1/submissions/nonsense{path}"), 404, "submission_not_found")


@pytest.mark.parametrize("path", ["/report", "/trajectory", "/plot.png"])
def test_a_submission_not_graded_yet(client: httpx.Client, upload: Upload, path: str) -> None:
    url = upload().headers["Location"]
    response = client.get(url + path)
    problem(response, 409, "not_graded_yet")
    assert int(response.headers["Retry-After"]) > 0


def test_an_unknown_case(client: httpx.Client, graded: Callable[..., str]) -> None:
    response = client.get(graded() + "/trajectory", params={"case": "other"})
    assert problem(response, 404, "no_trajectory")["allowed"] == ["default"]


def test_an_unknown_address(client: httpx.Client) -> None:
    problem(client.get("/api/v1/nothing"), 404, "not_found")
    problem(client.get("/docs"), 404, "not_found")


def test_an_unknown_assignment_page(client: httpx.Client) -> None:
    problem(client.get("/api/v1/assignments/circle"), 404, "assignment_not_found")


def test_a_method_that_is_not_there(client: httpx.Client) -> None:
    response = client.delete("/api/v1/assignments")
    problem(response, 405, "method_not_allowed")
    assert response.headers["Allow"] == "GET"
    assert client.put("/api/v1/regrades").headers["Allow"] == "GET, POST"
    assert client.post("/static/style.css").headers.get("Allow", "") != "POST"


def test_an_unknown_language(client: httpx.Client) -> None:
    document = problem(client.get("/api/v1/assignments", params={"lang": "fr"}), 422, "invalid_request")
    assert document["field"] == "query.lang"


@pytest.mark.parametrize(
    "header", [None, "", "Bearer", "Bearer wrong", f"Basic {TOKEN}", f"Bearer {TOKEN}x", "Bearer \xe9\xe9"]
)
def test_the_dashboard_without_its_token(client: httpx.Client, header: str | None) -> None:
    headers = [] if header is None else [(b"Authorization", header.encode("latin-1"))]
    response = client.get("/api/v1/dashboard", headers=headers)
    problem(response, 401, "unauthorized")
    assert response.headers["WWW-Authenticate"].startswith("Bearer")


def test_a_bug_is_a_problem_too(
    client: httpx.Client,
    services: Services,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    def bug() -> None:
        raise ZeroDivisionError("secret detail")

    monkeypatch.setattr(services.assignments, "all", bug)
    response = client.get("/api/v1/assignments")
    document = problem(response, 500, "internal_error")
    assert "secret" not in response.text
    assert response.headers["connection"] == "close"
    assert any(document["instance"] in record.getMessage() for record in caplog.records)


def test_a_database_that_is_away(
    client: httpx.Client, services: Services, monkeypatch: pytest.MonkeyPatch
) -> None:
    def away(_: str) -> None:
        raise InfrastructureError("database is locked")

    monkeypatch.setattr(services.submissions, "with_report", away)
    response = client.get("/api/v1/submissions/x")
    problem(response, 503, "unavailable")
    assert "Retry-After" in response.headers


def test_problems_speak_the_readers_language(upload: Upload) -> None:
    english = upload(b"", headers={"Accept-Language": "en"}).json()
    chinese = upload(b"").json()
    assert (english["title"], chinese["title"]) == ("The file is empty", "文件是空的")
    assert upload(b"", headers={"Accept-Language": "en"}).headers["Content-Language"] == "en"


def test_every_type_is_explained_at_its_address(client: httpx.Client) -> None:
    for code, type_ in PROBLEM_TYPES.items():
        document = client.get(f"/api/v1/problems/{code}", params={"lang": "en"}).json()
        assert document["title"] == type_.title.en
        assert document["fix"], code


def test_every_refusal_of_a_use_case_has_a_type() -> None:
    """A code without one would answer 500 instead of telling what is wrong."""
    named = {
        call.args[0].value
        for path in (ROOT / "grader").rglob("*.py")
        if path.parent.name != "commands"  # they print what happened and need no type
        if "RefusedError" in (source := path.read_text())  # reading the others as Python takes a second
        for call in ast.walk(ast.parse(source))
        if isinstance(call, ast.Call)
        and ast.unparse(call.func) in ("RefusedError", "RefusedError.saying")
        and call.args
        and isinstance(call.args[0], ast.Constant)
    }
    assert len(named) > 20
    assert named <= PROBLEM_TYPES.keys()
    assert set(get_args(RefusalCode)) <= PROBLEM_TYPES.keys()


def test_an_unknown_type(client: httpx.Client) -> None:
    problem(client.get("/api/v1/problems/nonsense"), 404, "problem_not_found")


def test_whatever_a_message_quotes_is_shown_escaped() -> None:
    request = Request(
        {"type": "http", "method": "GET", "path": "/", "headers": [], "query_string": b"lang=en"}
    )
    found = [problems._field_error({"loc": ("body", "\u202ename"), "msg": "not \x1b[2J", "type": "?"}, "en")]
    answer = problems._answer(request, "invalid_request", "line 1\nnot \x1b[2J\u202e", errors=found)
    document = json.loads(bytes(answer.body))
    assert document["detail"] == "line 1\nnot \\x1b[2J\\u202e"
    assert document["errors"] == [{"field": "\\u202ename", "detail": "not \\x1b[2J"}]
