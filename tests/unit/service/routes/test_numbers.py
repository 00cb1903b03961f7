"""Numbers in addresses are digits; everything else is refused with the name of its field."""

from typing import Any

import httpx
import pytest

from grader.use_cases.services import Services
from tests.fakes.refusals import problem

NO_NUMBERS = ("1_0", " 10", "+10", "10.0", "1e1", "١٠", "１０", "0x1", "nan", "", "9" * 5000)
NUMBERED = (
    ("/api/v1/judgements/waiting", "offset"),
    ("/api/v1/judgements/waiting", "limit"),
    ("/api/v1/dashboard", "offset"),
    ("/api/v1/dashboard", "limit"),
    ("/api/v1/audit", "before"),
    ("/api/v1/audit", "limit"),
    ("/api/v1/regrades/none", "offset"),
    ("/api/v1/regrades/none", "limit"),
)


@pytest.mark.parametrize(("path", "name"), NUMBERED)
def test_only_digits_are_a_number(client: httpx.Client, school: Any, path: str, name: str) -> None:
    headers = {**school.as_("wang"), "Accept-Language": "en"}
    for text in NO_NUMBERS:
        refused = problem(client.get(path, params={name: text}, headers=headers), 422, "invalid_request")
        assert refused["field"] == f"query.{name}", text
        assert "This is not a whole number." in refused["detail"], text
    answer = client.get(path, params={name: "10"}, headers=headers)
    assert answer.status_code == (404 if "none" in path else 200)


@pytest.mark.parametrize("page", ["/class", "/class/gradebook", "/class/judgements", "/class/audit"])
def test_pages_take_the_same_numbers(
    client: httpx.Client, services: Services, school: Any, page: str
) -> None:
    name = "before" if page.endswith("audit") else "page"
    client.cookies.clear()
    client.cookies.set("grader_session", services.callers.open_session(school.tokens["wang"]))
    try:
        assert client.get(page, params={name: "1"}).status_code == 200
        assert client.get(page, params={name: "1_0"}).status_code == 422
    finally:
        client.cookies.clear()
