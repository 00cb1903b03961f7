"""What every refusal has in common."""

import unicodedata

import httpx

from grader.use_cases.services import Services


def problem(response: httpx.Response, status: int, code: str) -> dict:
    assert response.status_code == status, response.text
    assert response.headers["content-type"] == "application/problem+json"
    document = response.json()
    assert {"type", "title", "status", "detail", "instance", "code", "fix"} <= document.keys()
    assert document["status"] == status
    assert document["code"] == code
    assert document["type"] == f"/api/v1/problems/{code}"
    assert document["instance"].startswith("urn:uuid:")
    assert None not in document.values()
    assert {unicodedata.category(each) for each in texts(document)}.isdisjoint({"Cc", "Cf", "Zl", "Zp"})
    return document


def texts(value: object) -> str:
    """All strings anywhere in a JSON document."""
    if isinstance(value, dict):
        return texts([*value.keys(), *value.values()])
    if isinstance(value, list):
        return "".join(map(texts, value))
    return str(value)


def nothing_stored(services: Services) -> bool:
    state = services.queue.state()
    return state.queued == 0
