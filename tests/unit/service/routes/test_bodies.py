"""Bodies of requests that are too long, broken, or none at all."""

import asyncio
from collections.abc import Callable
from typing import Any

import httpx
import pytest

from grader.service.requests.middleware import HeldToTheEnd
from grader.use_cases.services import Services
from tests.fakes.refusals import nothing_stored, problem

Upload = Callable[..., httpx.Response]


def test_a_file_one_byte_too_large(upload: Upload, services: Services) -> None:
    assert upload(b"#" * 2048).status_code == 202
    document = problem(upload(b"#" * 2049), 413, "too_large")
    assert "2 KiB" in document["detail"]
    assert services.queue.state().queued == 1


@pytest.mark.parametrize("declared", [True, False])
@pytest.mark.parametrize(
    ("path", "kind", "start"),
    [
        ("/api/v1/regrades", "application/json", b'{"assignment": "'),
        ("/enter", "application/x-www-form-urlencoded", b"token="),
        (
            "/enter",
            "multipart/form-data; boundary=b",
            b'--b\r\nContent-Disposition: form-data; name="f"\r\n\r\n',
        ),
    ],
)
def test_nobody_fills_the_memory_with_a_body_that_is_no_upload(
    client: httpx.Client, path: str, kind: str, start: bytes, declared: bool
) -> None:
    long = start + b"a" * 1024 * 1024
    content = long if declared else (long[at : at + 65_536] for at in range(0, len(long), 65_536))
    response = client.post(path, content=content, headers={"Content-Type": kind})
    assert "1024 KiB" in problem(response, 413, "too_large")["detail"]


def test_a_body_declared_far_too_large(upload: Upload, services: Services) -> None:
    problem(upload(b"#" * 3_000_000), 413, "too_large")
    assert nothing_stored(services)


def test_a_body_that_never_says_how_large_it_is(client: httpx.Client, services: Services) -> None:
    sent = 0

    def body():
        nonlocal sent
        yield b'--x\r\nContent-Disposition: form-data; name="file"; filename="a.py"\r\n\r\n'
        for _ in range(2_000):
            sent += 1000
            yield b"#" * 1000

    headers = {"Content-Type": "multipart/form-data; boundary=x"}
    problem(client.post("/api/v1/submissions", content=body(), headers=headers), 413, "too_large")
    assert nothing_stored(services)


@pytest.mark.parametrize("file_name", ["", '; filename="a.py"'], ids=["fields", "files"])
def test_a_form_of_many_parts(client: httpx.Client, services: Services, file_name: str) -> None:
    """Small enough to be an upload's, but each part costs the event loop as much as a small request."""
    names = ("assignment", "file", *(f"more{number}" for number in range(20)))
    parts = (f'--x\r\nContent-Disposition: form-data; name="{one}"{file_name}\r\n\r\n1\r\n' for one in names)
    headers = {"Content-Type": "multipart/form-data; boundary=x"}
    response = client.post("/api/v1/submissions", content="".join(parts) + "--x--\r\n", headers=headers)
    problem(response, 400, "malformed_body")
    assert nothing_stored(services)


@pytest.mark.parametrize(
    "kind", ["application/json", "text/x-python", "application/x-www-form-urlencoded", ""]
)
def test_a_body_that_is_no_upload(client: httpx.Client, kind: str) -> None:
    response = client.post("/api/v1/submissions", content=b"{}", headers={"Content-Type": kind})
    problem(response, 415, "unsupported_media_type")


@pytest.mark.parametrize(
    "body", [b"", b"garbage", b"--x\r\nbroken\r\n", b'--x\r\nContent-Disposition: form-data; name="file"']
)
def test_a_body_that_cannot_be_parsed(client: httpx.Client, services: Services, body: bytes) -> None:
    headers = {"Content-Type": "multipart/form-data; boundary=x"}
    response = client.post("/api/v1/submissions", content=body, headers=headers)
    assert response.status_code in (400, 422)
    problem(response, response.status_code, response.json()["code"])
    assert nothing_stored(services)


def test_a_boundary_that_is_missing(client: httpx.Client) -> None:
    headers = {"Content-Type": "multipart/form-data"}
    problem(client.post("/api/v1/submissions", content=b"x", headers=headers), 400, "malformed_body")


def test_a_large_answer_ends_only_after_its_body_was_taken() -> None:
    sent: list[tuple[int, bool]] = []

    async def answer(scope, receive, send) -> None:
        await send({"type": "http.response.start", "status": 200, "headers": []})
        await send({"type": "http.response.body", "body": b"a" * 100_000})
        await send({"type": "http.response.body", "body": b"a"})

    async def take(message) -> None:
        if "body" in message:
            sent.append((len(message["body"]), message.get("more_body", False)))

    asyncio.run(HeldToTheEnd(answer)({"type": "http"}, None, take))
    assert sent == [(100_000, True), (0, False), (1, False)]


def test_a_file_without_curls_at_sign_is_told_so(client: httpx.Client, services: Services) -> None:
    sent = client.post(
        "/api/v1/submissions", files={"file": (None, "square.py"), "assignment": (None, "square")}
    )
    document = problem(sent, 422, "invalid_request")
    assert document["field"] == "file"
    assert "-F file=@square.py" in document["detail"]
    assert nothing_stored(services)


@pytest.mark.parametrize("twice", ["file", "assignment"])
def test_of_two_parts_of_one_name_none_is_taken(twice: str, client: httpx.Client, services: Services) -> None:
    parts = [("file", ("a.py", b"good\n")), ("assignment", (None, "square"))]
    parts += [(name, part) for name, part in parts if name == twice]
    document = problem(client.post("/api/v1/submissions", files=parts), 422, "invalid_request")
    assert document["field"] == twice
    assert nothing_stored(services)


def test_no_form_has_a_part_that_is_not_read(client: httpx.Client, school: Any) -> None:
    """A class list with `dry_run` in the form, which belongs into the address, would be imported."""
    paths = client.get("/openapi.json").json()["paths"]
    forms = [
        path
        for path, methods in paths.items()
        if "multipart/form-data" in methods.get("post", {}).get("requestBody", {}).get("content", {})
    ]
    assert "/api/v1/members/import" in forms
    wang = school.as_("wang")
    for path in forms:
        params = {"column": "points"} if path.endswith("/fill") else {}
        file = ("file", ("a.py", b"x"))
        extra = client.post(path, params=params, files=[file], data={"dry_run": "true"}, headers=wang)
        fields = [one["field"] for one in problem(extra, 422, "invalid_request")["errors"]]
        assert fields[0] == "dry_run", path
        twice = client.post(path, params=params, files=[file, file], headers=wang)
        assert problem(twice, 422, "invalid_request")["field"] == "file", path
