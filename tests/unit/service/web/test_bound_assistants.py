"""The pages of an assistant who is bound to sections are about their students alone."""

from collections.abc import Callable

from fastapi.routing import APIRoute

from grader.contracts.identity import Role, RosterEntry
from grader.contracts.regrade import Wanted
from grader.contracts.rules import Extension
from grader.service.web.routing import ROUTERS
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.unit.service.web.conftest import Browser

ENDLESS = "/events"


def test_no_page_names_a_student_of_another_section(
    browser: Browser,
    services: Services,
    tokens: dict[str, str],
    put: Callable[..., str],
    grade_waiting: Callable[..., None],
) -> None:
    roster = [
        RosterEntry(id="li", name="", sections=("1",)),
        RosterEntry(id="han", name="Meimei", sections=("2",)),
        RosterEntry(id="ta", name="", role=Role.ASSISTANT, sections=("1",)),
    ]
    services.courses.import_roster("ros", roster, "wang")
    signed = Signature(services.clock(), "ros", "wang")
    services.rules.extend("square", "han", Extension(extra_attempts=3), signed)
    own, foreign = (put(student=who, course="ros", source=who.encode()) for who in ("li", "han"))
    regrade = services.regrades.open(Wanted(assignment="square"), signed).id
    grade_waiting(lambda job: job)
    browser.enter(token=tokens["ta"])
    assert browser.get(own).status_code == 200
    of = {
        "submission_id": foreign.rpartition("/")[2],
        "assignment_id": "square",
        "student": "han",
        "person": "han",
        "provider_id": "campus",
        "secret": "x" * 43,
        "regrade_id": regrade,
        "name": "grader.whl",
        "platform": "gradescope",
    }
    both = {"first": own.rpartition("/")[2], "second": of["submission_id"]}
    seen = {}
    for route in (route for router in ROUTERS for route in router.routes if isinstance(route, APIRoute)):
        if "GET" not in route.methods or route.path.endswith(ENDLESS):
            continue
        numbers = {"first": "1", "second": "1"}
        asked = numbers if "{submission_id}" in route.path else both
        is_pair = route.path.endswith(("/compare", "/pair"))
        answer = browser.get(route.path.format_map(of), params=asked if is_pair else {})
        if any(
            part in route.path for part in ("{submission_id}", "{student}", "{person}", "/compare", "/pair")
        ):
            assert answer.status_code == 404, route.path
        else:
            seen[route.path] = answer.text
    assert {path for path, text in seen.items() if of["submission_id"] in text or "Meimei" in text} == set()
    assert len(seen) > 15
    assert "li" in seen["/class"]
