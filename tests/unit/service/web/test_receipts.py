"""Receipts on the pages: a student saves one, staff checks it after the submission is gone."""

from collections.abc import Callable

from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.unit.service.web.conftest import Browser

PAGE = "/class/receipts"


def test_a_receipt_outlives_the_submission(
    browser: Browser, put: Callable[..., str], tokens: dict[str, str], services: Services
) -> None:
    address = put(b"good", student="li", course="ros")
    browser.get("/?lang=en")
    browser.enter(token=tokens["li"])
    assert f'{address}/receipt.txt" download' in browser.get(address).text
    saved = browser.get(f"{address}/receipt.txt")
    assert saved.headers["Content-Disposition"].startswith("attachment")

    browser.enter(token=tokens["ta"])
    there = browser.post(PAGE, {"receipt": saved.text}, page=PAGE).text
    assert "The receipt is genuine" in there
    assert f'href="{address}"' in there
    assert "the one that was handed in" not in there
    changed = browser.post(PAGE, {"receipt": saved.text.replace("square", "circle")}, page=PAGE)
    assert changed.status_code == 422
    assert "did not sign that receipt" in changed.text
    file = {"file": ("square.py", b"good", "text/x-python")}
    assert "The file is the one that was handed in" in browser.post(PAGE, {"receipt": saved.text}, file).text
    file = {"file": ("square.py", b"better", "text/x-python")}
    assert "The file is not the one" in browser.post(PAGE, {"receipt": saved.text}, file).text

    services.course_life.renumber("li", "li-2", Signature(services.clock(), "ros", "wang"))
    assert f'href="{address}"' in browser.post(PAGE, {"receipt": saved.text}, page=PAGE).text
    services.course_life.forget("li-2", Signature(services.clock(), "ros", "wang"))
    assert "is not in the database" in browser.post(PAGE, {"receipt": saved.text}, page=PAGE).text
