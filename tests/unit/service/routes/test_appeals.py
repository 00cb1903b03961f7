"""A student asks for another look at an item; staff answer, correct or refuse."""

from collections.abc import Callable
from typing import Any

import httpx
import pytest

from grader.contracts.rules import Corrector, Rules
from grader.store.appeals import Asked
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.fakes.clock import START, FakeClock
from tests.fakes.grading import grade
from tests.unit.service.routes.conftest import work

Asks = Callable[..., httpx.Response]


@pytest.fixture
def ruled(services: Services, school: Any) -> Callable[..., None]:
    """Rules of the square by which students may appeal."""

    def change(**rules: Any) -> None:
        signed = Signature(services.clock(), "ros", "wang")
        given = {"appeals_until": START.replace(year=START.year + 1), **rules}
        services.rules.set("square", Rules(**given), signed)

    change()
    return change


@pytest.fixture
def driven(graded: Callable[..., str], school: Any) -> str:
    """Address of a submission by ``li`` that earns 5 of 10 points: ``closed`` failed."""
    return graded(source=b"good\n", student="", headers=school.as_("li"))


@pytest.fixture
def ask(client: httpx.Client, school: Any, driven: str) -> Asks:
    def send(item: str = "closed", by: str = "li", reason: str = "It came back.") -> httpx.Response:
        body = {"item": item, "reason": reason}
        return client.post(f"{driven}/appeals", json=body, headers=school.as_(by))

    return send


@pytest.fixture
def answer(client: httpx.Client, school: Any, driven: str) -> Asks:
    def send(by: str = "ta", seen: str | None = None, **body: Any) -> httpx.Response:
        headers = school.as_(by) | ({} if seen is None else {"If-Match": seen})
        return client.put(
            f"{driven}/appeals/closed", json={"text": "Look at the end.", **body}, headers=headers
        )

    return send


def code(response: httpx.Response) -> tuple[int, str]:
    return response.status_code, response.json()["code"]


def actions(services: Services) -> list[str]:
    entries = services.audit.entries("ros", 20)
    return [one.action for one in reversed(entries) if one.action.startswith(("appeal", "grade"))]


def test_one_appeal_for_each_item_that_can_gain(
    ruled: Any, ask: Asks, client: httpx.Client, school: Any
) -> None:
    made = ask().json()
    assert (made["state"], made["earned"], made["points"], made["answered_by"]) == ("open", 0.0, 5.0, None)
    assert code(ask()) == (409, "appeal_exists")
    assert code(ask("sides")) == (422, "invalid_request")  # it has all its points
    assert code(ask("none")) == (404, "item_not_found")
    assert code(ask(by="wang")) == (403, "forbidden")
    assert code(ask(reason=" ")) == (422, "invalid_request")
    listed = client.get("/api/v1/appeals", headers=school.as_("ta")).json()
    assert (listed["total"], listed["waiting"], listed["appeals"]) == (1, 1, [made])
    elsewhere = client.get("/api/v1/appeals?assignment=straight", headers=school.as_("ta"))
    assert elsewhere.json()["total"] == 0
    misspelt = client.get("/api/v1/appeals?assignment=sqare", headers=school.as_("ta"))
    assert code(misspelt) == (422, "unknown_assignment")


def test_appeals_are_off_by_default_and_end_at_their_date(
    ruled: Callable[..., None], ask: Asks, clock: FakeClock
) -> None:
    ruled(appeals_until=None)
    assert code(ask()) == (403, "appeals_closed")
    ruled(appeals_until=clock())
    assert code(ask()) == (403, "appeals_closed")


def test_hidden_items_take_no_appeal_and_hide_the_one_there_is(
    ruled: Callable[..., None], ask: Asks, driven: str, client: httpx.Client, school: Any
) -> None:
    ruled(hidden_items=("closed",))
    assert code(ask()) == (404, "item_not_found")
    ruled()
    assert ask().status_code == 201
    ruled(hidden_items=("closed",))
    shown = {who: client.get(f"{driven}/appeals", headers=school.as_(who)).json() for who in ("li", "ta")}
    assert (len(shown["li"]["appeals"]), len(shown["ta"]["appeals"])) == (0, 1)


def test_one_that_was_taken_back_may_be_made_again(
    ruled: Any, ask: Asks, driven: str, client: httpx.Client, school: Any, services: Services
) -> None:
    ask()
    address, li = f"{driven}/appeals/closed", school.as_("li")
    assert client.delete(address, headers=li).status_code == 204
    assert code(client.delete(address, headers=li)) == (409, "appeal_decided")
    assert client.get("/api/v1/appeals", headers=school.as_("ta")).json()["total"] == 0
    assert ask(reason="Again.").json()["reason"] == "Again."
    assert actions(services) == ["appeal.make", "appeal.withdraw", "appeal.make"]


@pytest.mark.parametrize("state", ["answered", "refused"])
def test_words_leave_the_points(
    ruled: Any, ask: Asks, answer: Asks, driven: str, client: httpx.Client, school: Any, state: str
) -> None:
    assert code(answer(state=state)) == (404, "appeal_not_found")
    ask()
    assert answer(state=state, points=5.0).status_code == 422
    told = answer(state=state).json()
    assert (told["state"], told["answer"], told["answered_by"], told["seen"]) == (
        state, "Look at the end.", "ta", False,
    )  # fmt: skip
    assert code(answer(state="refused")) == (409, "appeal_decided")
    li = school.as_("li")
    assert client.get(driven, headers=li).json()["score"] == 5.0
    assert client.get(f"{driven}/appeals", headers=li).json()["appeals"][0]["answered_by"] is None
    assert code(client.delete(f"{driven}/appeals/closed", headers=li)) == (409, "appeal_decided")
    assert code(ask()) == (409, "appeal_exists")
    answered = client.get("/api/v1/appeals", params={"state": "answered"}, headers=school.as_("ta")).json()
    assert (answered["total"], answered["waiting"]) == (1, 0)


def test_a_correction_answers(
    ruled: Callable[..., None],
    ask: Asks,
    answer: Asks,
    driven: str,
    client: httpx.Client,
    school: Any,
    services: Services,
) -> None:
    ask()
    corrected = {"state": "corrected", "points": 4.0}
    assert answer(state="corrected").status_code == 422
    assert code(answer(**corrected)) == (403, "forbidden")  # an assistant
    assert code(answer("wang", '"1.x"', **corrected)) == (412, "judged_meanwhile")
    ruled(corrected_by=Corrector.STAFF)
    assert answer(**corrected).json()["state"] == "corrected"
    shown = client.get(driven, headers=school.as_("li")).json()
    assert (shown["score"], shown["rubric"][1]["earned"]) == (9.0, 4.0)
    assert actions(services) == ["appeal.make", "grade.judge", "appeal.corrected"]


def test_points_given_elsewhere_answer_too_and_only_once(
    ruled: Any, ask: Asks, answer: Asks, driven: str, give: Any, client: httpx.Client, school: Any
) -> None:
    ask()
    assert give(driven, "closed", 2.5, "wang", comment="I looked.").status_code == 200
    (told,) = client.get(f"{driven}/appeals", headers=school.as_("li")).json()["appeals"]
    assert (told["state"], told["answer"]) == ("corrected", "I looked.")
    late = answer("wang", "*", state="corrected", points=5.0)
    assert code(late) == (409, "appeal_decided")


def test_points_by_hand_answer_in_words(
    answered: Callable[..., str], give: Any, school: Any, services: Services
) -> None:
    """Points for an answer need no comment, unless its student has asked for another look."""
    url = answered()
    assert give(url, "timer", 10.0).status_code == 200
    asked = Asked(item="timer", reason="I wrote more.", attempt=1, earned=10.0, points=45.0)
    services.appeals.ask(url.rpartition("/")[2], asked, Signature(services.clock(), "ros", "li"))
    assert code(give(url, "timer", 20.0, seen="*")) == (422, "invalid_request")
    assert give(url, "timer", 20.0, seen="*", comment="You did.").status_code == 200
    assert actions(services)[-1] == "appeal.corrected"


def test_a_regrade_and_a_new_submission_leave_it_open(
    ruled: Any, ask: Asks, graded: Any, client: httpx.Client, school: Any, services: Services
) -> None:
    ask()
    wang = school.as_("wang")
    opened = client.post("/api/v1/regrades", json={"assignment": "square"}, headers=wang).headers["Location"]
    work(services, grade)
    assert client.post(opened + "/apply", json={"reason": "x"}, headers=wang).status_code == 200
    graded(source=b"good good\n", student="", headers=school.as_("li"))
    assert client.get("/api/v1/appeals", headers=wang).json()["waiting"] == 1
