"""Points by a person as pages: what waits, one answer after the other, what the student sees."""

import re
from collections.abc import Callable
from html import unescape

import pytest

from grader.contracts.rules import Rules
from grader.contracts.submission import SubmissionState
from grader.store.audit import Signature
from grader.store.judgements import Given
from grader.use_cases.services import Services
from tests.fakes.essays import grade_essay
from tests.unit.service.web.conftest import Browser

QUESTION = "theory_publisher_timer"
EVIL = b"A publisher sends, a timer calls.\r\n\r\n<script>alert(1)</script>\xe2\x80\xae\n"


@pytest.fixture
def answers(put: Callable[..., str]) -> dict[str, str]:
    """Ids of two students' answers, in order of arrival, and of one that is too short to be judged."""
    sources = {"li": EVIL, "han": b"A publisher publishes and a timer ticks."}
    return {
        student: put(
            source, student=student, course="ros", assignment=QUESTION, name="a.txt", grading=grade_essay
        ).rpartition("/")[2]
        for student, source in sources.items()
    }


@pytest.fixture
def ta(browser: Browser, tokens: dict[str, str], answers: dict[str, str]) -> Browser:
    browser.get("/?lang=en")
    browser.enter(token=tokens["ta"])
    return browser


def desk(submission: str, item: str = "timer") -> str:
    return f"/class/judgements/{submission}?item={item}"


def state(browser: Browser, page: str) -> str:
    """What the form says was looked at."""
    seen = re.search(r'name="seen" value="([^"]*)"', browser.get(page).text)
    assert seen is not None
    return unescape(seen[1])


def give(browser: Browser, submission: str, item: str = "timer", **fields: str):
    page = desk(submission, item)
    data = {"item": item, "points": "40", "comment": "", "seen": state(browser, page), **fields}
    return browser.post(f"/class/judgements/{submission}", data, page=page)


def test_what_waits_is_listed_by_question(ta: Browser, answers: dict[str, str]) -> None:
    text = ta.get("/class/judgements").text
    assert "What create_timer does" in text
    # both items, and the way to begin
    assert text.count(f'href="/class/judgements/{answers["li"]}?item=') == 3
    only = ta.get(f"/class/judgements?assignment={QUESTION}&item=timer").text
    assert f"{answers['li']}?item=publisher" not in only
    assert '<strong>2</strong> <a href="/class/judgements">' in ta.get("/class").text


def test_names_can_be_hidden(ta: Browser, answers: dict[str, str]) -> None:
    for page in ("/class/judgements?", desk(answers["li"]) + "&"):
        assert ">li" in ta.get(page).text
        assert not re.search(r">\s*li\b", ta.get(page + "anonymous=1").text)


def test_a_list_does_not_tell_that_a_hidden_item_waits(
    ta: Browser, answers: dict[str, str], services: Services, tokens: dict[str, str]
) -> None:
    hidden = Rules(hidden_items=("timer",))
    services.rules.set(QUESTION, hidden, Signature(services.clock(), "ros", "test"))
    give(ta, answers["li"], "publisher")
    ta.enter(token=tokens["li"])
    assert "waiting for a person" not in ta.get(f"/submissions/{answers['li']}?lang=en").text
    for page in ("/submissions?lang=en", f"/assignments/{QUESTION}?lang=en"):
        assert f'href="/submissions/{answers["li"]}"' in ta.get(page).text
        assert "waiting for a person" not in ta.get(page).text


def test_names_stay_hidden_after_the_last_answer(ta: Browser, answers: dict[str, str]) -> None:
    first = give(ta, answers["li"], anonymous="1").headers["Location"]
    assert first.startswith(f"/class/judgements/{answers['han']}?item=timer&anonymous=1")
    assert give(ta, answers["han"], anonymous="1").headers["Location"] == "/class/judgements?anonymous=1"


def test_an_answer_keeps_its_lines_and_is_only_text(ta: Browser, answers: dict[str, str]) -> None:
    text = ta.get(desk(answers["li"])).text
    assert "timer calls.\n\n&lt;script&gt;alert(1)&lt;/script&gt;\\u202e\n</pre>" in text.replace("\r", "")


def test_points_lead_from_answer_to_answer(ta: Browser, answers: dict[str, str], services: Services) -> None:
    answer = give(ta, answers["li"], points="40,5", comment="Good.\r\nSay who calls it.")
    assert answer.headers["Location"].startswith(f"/class/judgements/{answers['han']}?item=timer")
    assert give(ta, answers["han"]).headers["Location"] == "/class/judgements"
    assert (
        give(ta, answers["han"], then="stay")
        .headers["Location"]
        .startswith(f"/class/judgements/{answers['han']}")
    )
    assert services.submissions.get(answers["li"]).score is None  # one item still waits
    give(ta, answers["li"], "publisher", points="45")
    assert services.submissions.get(answers["li"]).score == 95.5
    assert services.submissions.get(answers["li"]).state is SubmissionState.GRADED
    (entry, *_) = [one for one in services.audit.entries("ros", 10) if "timer" in one.subject][-1:]
    assert (entry.action, entry.actor) == ("grade.judge", "ta")


def test_the_student_sees_points_and_comment(
    ta: Browser, answers: dict[str, str], tokens: dict[str, str]
) -> None:
    give(ta, answers["li"], points="40.5", comment="Good.\nSay who <calls> it.")
    assert 'href="/class/judgements/' in ta.get(f"/submissions/{answers['li']}").text
    ta.enter(token=tokens["li"])
    text = ta.get(f"/submissions/{answers['li']}").text
    assert "Good.\nSay who &lt;calls&gt; it." in text
    assert '<span class="points">40.5<span class="of"> / 45' in text
    assert '<span class="points">—<span class="of"> / 45' in text  # the other one waits
    assert 'href="/class/judgements/' not in text


@pytest.mark.parametrize(
    "points", ["", "many", "1_0", "1e1", "١٠", "1,000", "-1", "45.5", "1.234", "nan", "inf", "1e999"]
)
def test_points_out_of_range_are_told_at_the_field(
    ta: Browser, answers: dict[str, str], services: Services, points: str
) -> None:
    answer = give(ta, answers["li"], points=points, comment="kept")
    assert answer.status_code == 422
    assert re.search(r'id="points"[^>]*aria-invalid="true"[^>]*aria-describedby="points-error', answer.text)
    assert "Give points from 0 to 45" in answer.text
    assert ">kept</textarea>" in answer.text
    assert services.submissions.report(answers["li"]).judgements == ()


def test_a_comment_that_is_too_long_is_told_at_the_field(ta: Browser, answers: dict[str, str]) -> None:
    answer = give(ta, answers["li"], comment="x" * 2_001)
    assert answer.status_code == 422
    assert 'id="comment-error"' in answer.text


def test_two_people_do_not_overwrite_each_other(
    ta: Browser, answers: dict[str, str], services: Services
) -> None:
    seen = state(ta, desk(answers["li"]))
    signed = Signature(services.clock(), "ros", "wang")
    services.judgements.judge_all(
        answers["li"], [(Given(item="timer", points=1.0, comment="first"), None)], signed
    )
    answer = give(ta, answers["li"], seen=seen)
    assert answer.status_code == 422
    assert "judged or graded again meanwhile" in answer.text
    assert "first" in answer.text  # what the other one gave
    assert 'id="points" name="points" value="40"' in answer.text  # what was typed
    assert len(services.submissions.report(answers["li"]).judgements) == 1


def test_what_was_given_is_shown_and_can_be_changed(
    ta: Browser, answers: dict[str, str], services: Services
) -> None:
    give(ta, answers["li"], points="40", comment="first")
    text = ta.get(desk(answers["li"])).text
    assert 'id="points" name="points" value="40"' in text
    assert "Given before" in text
    give(ta, answers["li"], points="41")
    assert [one.points for one in services.submissions.report(answers["li"]).judgements] == [40.0, 41.0]


def test_unknown_items_are_told(ta: Browser, answers: dict[str, str], put: Callable[..., str]) -> None:
    assert ta.get(desk(answers["li"], "nothing")).status_code == 404
    script = put(b"good", student="li", course="ros").rpartition("/")[2]
    assert ta.get(f"/class/judgements/{script}").status_code == 404


def test_the_matrix_finds_who_waits_for_a_person(ta: Browser, answers: dict[str, str]) -> None:
    text = ta.get("/class?show=judge").text
    assert "2 of 2 students" in text
    assert "waiting for a person" in text
    for student in answers.values():
        for item in ("timer", "publisher"):
            give(ta, student, item)
    assert "0 of 2 students" in ta.get("/class?show=judge").text
    assert "Nothing waits for a person" in ta.get("/class/judgements").text


def whole(browser: Browser, submission: str, **fields: object):
    page = f"/class/judgements/{submission}/whole"
    text = browser.get(page).text
    items, seen = (re.findall(rf'name="{name}" value="([^"]*)"', text) for name in ("item", "seen"))
    data = {"item": items, "seen": [unescape(one) for one in seen], **fields}
    return browser.post(page, data, page=page)


def test_a_whole_answer_is_judged_on_one_page(
    ta: Browser, answers: dict[str, str], services: Services
) -> None:
    assert f"/class/judgements/{answers['li']}/whole" in ta.get("/class/judgements").text
    text = ta.get(f"/class/judgements/{answers['li']}/whole").text
    assert text.count('name="points"') == 2
    assert "timer calls.\n" in text.replace("\r", "")
    sent = whole(ta, answers["li"], points=["40", "5,5"], comment=["Good.", ""])
    assert sent.headers["Location"] == f"/class/judgements/{answers['han']}/whole?anonymous=0"
    given = {
        one.item: (one.points, one.comment) for one in services.submissions.report(answers["li"]).judgements
    }
    assert sorted(given.values()) == [(5.5, ""), (40.0, "Good.")]
    assert services.submissions.get(answers["li"]).state is SubmissionState.GRADED
    # what is left empty, or as it was, stays
    whole(ta, answers["li"], points=["40", "6"], comment=["Good.", ""])
    assert len(services.submissions.report(answers["li"]).judgements) == 3
    last = whole(ta, answers["han"], points=["1", ""], comment=["", ""])
    assert last.headers["Location"] == "/class/judgements?anonymous=0"
    assert len(services.submissions.report(answers["han"]).judgements) == 1


def test_what_is_wrong_in_a_whole_answer_is_told_at_its_field(
    ta: Browser, answers: dict[str, str], services: Services
) -> None:
    wrong = whole(ta, answers["li"], points=["99", "40"], comment=["kept", "x" * 2_001])
    assert wrong.status_code == 422
    assert wrong.text.count('aria-invalid="true"') == 2
    assert ">kept</textarea>" in wrong.text
    assert services.submissions.report(answers["li"]).judgements == ()
    script_page = ta.get("/class/judgements/nothing/whole")
    assert script_page.status_code == 404


def test_comments_are_kept_under_keys(ta: Browser, answers: dict[str, str], services: Services) -> None:
    page = "/class/judgements/phrases"
    lines = {"phrases": "q Who calls <it>?\r\n\r\n好 写得清楚"}
    assert ta.post(page, lines, page=page).headers["Location"] == page + "?saved=true"
    assert services.phrases.of("ros") == {"q": "Who calls <it>?", "好": "写得清楚"}
    for shown in (desk(answers["li"]), f"/class/judgements/{answers['li']}/whole"):
        assert 'data-phrase="q" value="Who calls &lt;it&gt;?"' in ta.get(shown).text
    for wrong in ("q a\nq b", "nothing", "x" * 17 + " a", "a " + "x" * 2_001):
        refused = ta.post(page, {"phrases": wrong}, page=page)
        assert (refused.status_code, 'id="phrases-error"' in refused.text) == (422, True), wrong[:20]
    ta.post(page, {"phrases": ""}, page=page)
    assert services.phrases.of("ros") == {}
