"""What points that people gave become: with lateness, under rules, after grading again."""

from collections.abc import Callable
from typing import Any

import httpx

from grader.contracts.grading import GradingJob
from grader.contracts.rules import Counts, Rules
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.fakes.clock import START
from tests.fakes.essays import ANSWER, grade_essay, question
from tests.unit.service.routes.conftest import work


def test_lateness_and_the_rules_work_on_the_judged_score(
    client: httpx.Client,
    school: Any,
    services: Services,
    answered: Callable[..., str],
    give: Callable[..., httpx.Response],
) -> None:
    rules = Rules(counts=Counts.LAST)
    services.rules.set("essay", rules, Signature(START, "ros", "wang"))
    first, last = answered(), answered(answer=ANSWER * 2)

    def counted() -> object:
        students = client.get("/api/v1/dashboard", headers=school.as_("ta")).json()["students"]
        return students[0]["assignments"]["essay"]["counted_score"]

    for item in ("publisher", "timer"):
        give(first, item, 45)
    assert counted() == 100.0  # the last one that is graded
    for item in ("publisher", "timer"):
        give(last, item, 20)
    assert counted() == 50.0


def test_a_regrade_keeps_what_still_fits_and_says_so(
    client: httpx.Client,
    school: Any,
    services: Services,
    answered: Callable[..., str],
    give: Callable[..., httpx.Response],
) -> None:
    url = answered()
    for item in ("publisher", "timer"):
        give(url, item, 30)

    def regrade() -> dict[str, Any]:
        order = {"assignment": "essay"}
        opened = client.post("/api/v1/regrades", json=order, headers=school.as_("wang")).headers["Location"]
        assert work(services, grade_essay) == 1
        trial: dict[str, Any] = client.get(opened, headers=school.as_("ta")).json()
        applied = client.post(opened + "/apply", json={"reason": "x"}, headers=school.as_("wang")).json()
        assert {**trial, **applied} | {"waiting": 0} == applied | {"waiting": 0}
        assert (trial["kept"], trial["changes"]) == (applied["kept"], applied["changes"])
        return trial

    same = regrade()
    assert (same["same"], same["kept"], same["changes"]) == (1, 2, [])
    assert client.get(url, headers=school.as_("li")).json()["score"] == 70.0

    services.assignments.assignments = (question(version=2, timer_points=20.0),)
    changed = regrade()
    (change,) = changed["changes"]
    assert (change["before"], change["after"]) == (70.0, None)
    assert (change["kept"], change["void"]) == (["publisher"], ["timer"])
    half = client.get(url, headers=school.as_("li")).json()
    assert (half["score"], half["verdict"], half["to_judge"]) == (None, "needs_manual", 1)
    seen = client.get(url + "/judgements/timer", headers=school.as_("ta")).headers["ETag"]
    assert give(url, "timer", 20, seen=seen).status_code == 200
    assert client.get(url, headers=school.as_("li")).json()["score"] == 60.0


def test_a_trial_cannot_be_judged_which_would_keep_it_from_being_decided(
    client: httpx.Client,
    school: Any,
    answered: Callable[..., str],
    give: Callable[..., httpx.Response],
    services: Services,
) -> None:
    answered()
    wang = school.as_("wang")
    regrade = client.post("/api/v1/regrades", json={"assignment": "essay"}, headers=wang).headers["Location"]
    claim = services.queue.claim("w")
    assert claim is not None
    job = GradingJob(file_name=claim.file_name, source=claim.source, assignment=question())
    assert services.queue.finish(claim, grade_essay(job), question())
    assert give(f"/api/v1/submissions/{claim.submission_id}", "timer", 3).status_code == 404
    assert client.post(regrade + "/discard", json={"reason": "try"}, headers=wang).status_code == 200
