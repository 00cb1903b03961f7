"""Whatever is sent, the answer is an acceptance or a problem document, never a fault of the service."""

from urllib.parse import quote

import httpx
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from grader.contracts.submission import SubmissionState
from grader.use_cases.services import Services
from tests.examples import examples

quick = settings(
    max_examples=examples(60), deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
texts = st.text(max_size=80)
names = st.one_of(texts, st.text(max_size=20).map(lambda stem: stem + ".py"), st.just("a.py"))
students = st.one_of(texts, st.from_regex(r"[A-Za-z0-9]{1,12}", fullmatch=True))
sources = st.one_of(st.binary(max_size=3000), texts.map(lambda text: text.encode("utf-8", "surrogatepass")))


@pytest.fixture
def taken() -> set[str]:
    """The submissions of all examples: what was handed in before is answered with its earlier submission."""
    return set()


def answers_well(response: httpx.Response) -> None:
    assert response.status_code < 500, response.text
    if response.status_code >= 400:
        assert response.headers["content-type"] == "application/problem+json"
        assert response.json()["status"] == response.status_code


@quick
@given(source=sources, name=names, student=students, assignment=st.one_of(texts, st.just("square")))
def test_any_upload(
    client: httpx.Client,
    services: Services,
    taken: set[str],
    source: bytes,
    name: str,
    student: str,
    assignment: str,
) -> None:
    response = client.post(
        "/api/v1/submissions",
        files={"file": (name, source)},
        data={"assignment": assignment, "student": student},
    )
    answers_well(response)
    if response.status_code == 202:
        id_ = response.json()["id"]
        taken.add(id_)
        assert services.submissions.source(id_) == source
        assert services.submissions.get(id_).state is SubmissionState.QUEUED
    assert services.queue.state().queued == len(taken)


@quick
@given(body=st.binary(max_size=400), boundary=st.text("abc-'\"; ", max_size=8))
def test_any_body(client: httpx.Client, body: bytes, boundary: str) -> None:
    headers = {"Content-Type": f"multipart/form-data; boundary={boundary}".strip()}
    response = client.post("/api/v1/submissions", content=body, headers=headers)
    assert response.status_code != 202
    answers_well(response)


@quick
@given(
    start=st.sampled_from(["/api/v1/submissions/", "/api/v1/assignments/", "/api/v1/problems/", "/"]),
    rest=texts,
    language=texts,
)
def test_any_address(client: httpx.Client, start: str, rest: str, language: str) -> None:
    path = start + quote(rest.encode("utf-8", "surrogatepass"), safe="")
    answers_well(client.get(path))
    answers_well(client.get(path, headers={"Accept-Language": quote(language.encode("utf-8", "replace"))}))
    answers_well(client.get(path, params={"lang": language.encode("utf-8", "replace").decode()}))
