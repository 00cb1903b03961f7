"""The rules of assignments as pages: what a form says, what is wrong at which field, who got more."""

import re
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from zoneinfo import ZoneInfo

import httpx
import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.contracts.fields import Share, kinds_of
from grader.contracts.identity import RosterEntry
from grader.contracts.rules import (
    LATE_PARAMETERS,
    NO_EXTENSION,
    NO_RULES,
    Counts,
    Extension,
    LateKind,
    LateRule,
    Rules,
    Shown,
)
from grader.messages import is_on_page
from grader.service.web.rule_form import (
    Reader,
    RuleForm,
    TypedFieldError,
    _read,
    form_of,
    late_parameters,
    typed_name,
)
from grader.store.audit import Signature
from grader.use_cases.services import Services
from tests.fakes.late_rules import EXAMPLES, late_rules
from tests.unit.service.web.conftest import Browser

SHANGHAI = ZoneInfo("Asia/Shanghai")
PAGE = "/class/rules/square"
DUE = datetime(2026, 3, 20, 15, 59, tzinfo=UTC)  # 23:59 in Shanghai
instants = st.datetimes(datetime(2001, 1, 1), datetime(2199, 1, 1), timezones=st.just(UTC))


@st.composite
def rule_sets(draw: st.DrawFn) -> Rules:
    opens, due = sorted(draw(st.lists(instants, min_size=2, max_size=2, unique=True)))
    opened = draw(st.sampled_from([None, opens]))
    return Rules(
        shown=draw(st.sampled_from([one for one in Shown if opened or one is not Shown.WHEN_OPEN])),
        opens=opened,
        due=due,
        late=draw(late_rules()),
        accept_late_s=draw(st.none() | st.integers(0, 10**8)),
        attempts=draw(st.none() | st.integers(1, 10_000)),
        attempts_per_day=draw(st.none() | st.integers(1, 10_000)),
        counts=draw(st.sampled_from(Counts)),
        hidden_items=tuple(draw(st.sets(st.sampled_from(["a", "b"])))),
        hidden_until=draw(st.none() | instants),
    )


@given(rule_sets(), st.sampled_from(["Asia/Shanghai", "Europe/Berlin", "UTC"]))
def test_an_untouched_form_changes_nothing(rules: Rules, zone: str) -> None:
    reader = Reader(ZoneInfo(zone))
    assert reader.rules(form_of(rules, ZoneInfo(zone)), rules, frozenset("ab")) == rules
    assert reader.errors == {}


@given(rule_sets())
def test_what_is_shown_means_what_is_meant(rules: Rules) -> None:
    """Typed anew, without the rules it was made from, a form means the same to the digits it shows."""
    form = form_of(rules, SHANGHAI)
    again = Reader(SHANGHAI).rules(form, NO_RULES, frozenset("ab"))
    assert form_of(again, SHANGHAI) == form
    assert again.accept_late_s == rules.accept_late_s
    assert [one.after_s for one in again.late.steps] == [one.after_s for one in rules.late.steps]


@pytest.mark.parametrize(
    ("typed", "field", "sentence"),
    [
        ({"due": "tomorrow"}, "due", "rules.error.instant"),
        ({"due": "2026-03-20"}, "due", "rules.error.instant"),
        ({"due": "1999-12-31T23:59"}, "due", "rules.error.years"),
        ({"opens": "2026-03-20T23:59", "due": "2026-03-20T23:59"}, "due", "rules.error.order"),
        ({"counts": "best_before_due"}, "counts", "rules.error.needs_due"),
        ({"late": "linear"}, "per_day", "rules.error.percent"),
        ({"late": "linear", "per_day": "0"}, "per_day", "rules.error.percent"),
        ({"late": "linear", "per_day": "nan"}, "per_day", "rules.error.percent"),
        ({"late": "linear", "per_day": "101"}, "per_day", "rules.error.percent"),
        ({"late": "steps"}, "steps", "rules.error.no_steps"),
        ({"late": "steps", "step_after": ["1"], "step_keep": [""]}, "steps", "rules.error.step"),
        ({"late": "steps", "step_after": ["x"], "step_keep": ["5"]}, "steps", "rules.error.hours"),
        (
            {"late": "steps", "step_after": ["2", "1"], "step_keep": ["9", "5"]},
            "steps",
            "rules.error.steps_order",
        ),
        ({"accept_late": "-1"}, "accept_late", "rules.error.hours"),
        ({"accept_late": "inf"}, "accept_late", "rules.error.hours"),
        ({"attempts": "0"}, "attempts", "rules.error.count_from_1"),
        ({"attempts": "two"}, "attempts", "rules.error.count"),
        ({"attempts": "1_0"}, "attempts", "rules.error.count"),
        ({"attempts": "１０"}, "attempts", "rules.error.count"),
        ({"attempts": "1e1"}, "attempts", "rules.error.count"),
        ({"accept_late": "1_0"}, "accept_late", "rules.error.hours"),
        ({"accept_late": "1e1"}, "accept_late", "rules.error.hours"),
        ({"attempts_per_day": "10001"}, "attempts_per_day", "rules.error.count_from_1"),
        ({"hidden_items": ["gone"]}, "hidden_items", "rules.error.items"),
    ],
)
def test_each_mistake_is_told_at_its_field(typed: dict, field: str, sentence: str) -> None:
    reader = Reader(SHANGHAI)
    assert reader.rules(RuleForm(**typed), NO_RULES, frozenset("ab")) == NO_RULES
    assert reader.errors == {field: sentence}


@pytest.mark.parametrize("kind", LATE_PARAMETERS)
def test_a_late_rule_without_its_values_is_told_at_one_of_its_fields(kind: LateKind) -> None:
    reader = Reader(SHANGHAI)
    made = reader.rules(RuleForm(late=kind), NO_RULES, frozenset())
    assert set(reader.errors) <= {typed_name(name) for name in LATE_PARAMETERS[kind]}
    assert made.late == (LateRule() if reader.errors else LateRule(kind=kind))
    assert all(map(is_on_page, reader.errors.values()))


@pytest.mark.parametrize(
    ("typed", "seconds"),
    [
        ("48", 172_800),
        ("0.25", 900),
        ("15 min", 900),
        ("15分钟", 900),
        ("1.5 h", 5_400),
        ("2小时", 7_200),
        ("0 min", 0),
    ],
)
def test_durations_are_typed_in_hours_or_minutes(typed: str, seconds: int) -> None:
    reader = Reader(SHANGHAI)
    assert reader.rules(RuleForm(accept_late=typed), NO_RULES, frozenset()).accept_late_s == seconds
    assert reader.errors == {}


@pytest.mark.parametrize("typed", ["min", "15 m", "15 min 20", "1\n5", "-5 min", "15 %", "9999999 min"])
def test_what_is_no_duration_is_told(typed: str) -> None:
    reader = Reader(SHANGHAI)
    reader.rules(RuleForm(accept_late=typed), NO_RULES, frozenset())
    assert reader.errors == {"accept_late": "rules.error.hours"}


def test_what_is_wrong_with_a_share_says_whether_nothing_is_one() -> None:
    with pytest.raises(TypedFieldError, match=r"^rules\.error\.percent$"):
        _read(Share(positive=True), "x", SHANGHAI)
    with pytest.raises(TypedFieldError, match=r"^rules\.error\.percent_from_0$"):
        _read(Share(), "101", SHANGHAI)
    assert _read(Share(), "0 %", SHANGHAI) == 0.0


@pytest.mark.parametrize("kind", EXAMPLES)
def test_every_late_rule_is_told_wherever_rules_are(
    wang: Browser, services: Services, kind: LateKind
) -> None:
    rules = Rules(due=DUE, late=EXAMPLES[kind])
    services.rules.set("square", rules, Signature(services.clock(), "ros", "wang"))
    for page in ("/class/rules", PAGE, "/class/audit", "/assignments/square"):
        assert wang.get(page).status_code == 200, page
    assert f'value="{kind}" checked' in wang.get(PAGE).text


def test_the_form_asks_for_every_field_of_the_rules(wang: Browser) -> None:
    text = wang.get(PAGE).text
    asked = set(re.findall(r'name="(\w+)"', text))
    late = {"step_after" if name == "steps" else name for name in late_parameters()}
    elsewhere = {"by_section"}  # has a page for each section
    assert {typed_name(name) for name in [*kinds_of(Rules), *late]} - elsewhere <= asked
    assert set(kinds_of(LateRule)) == {"kind", *late_parameters()}
    assert {typed_name(name) for name in kinds_of(Extension)} <= asked


def test_the_style_sheet_shows_the_parameters_of_the_chosen_late_rule(wang: Browser) -> None:
    style = wang.get("/static/style.css").text
    for kind in {kind for kinds in late_parameters().values() for kind in kinds}:
        assert f".late:has(#late-{kind}:checked) .when-{kind}" in style


@pytest.fixture
def wang(browser: Browser, tokens: dict[str, str]) -> Browser:
    browser.get("/?lang=en")
    browser.enter(token=tokens["wang"])
    return browser


def rules_of(services: Services) -> Rules:
    return services.rules.of("ros").of("square")


def test_rules_are_set_on_the_clock_of_the_course(wang: Browser, services: Services) -> None:
    typed = {
        "due": "2026-03-20T23:59", "late": "linear", "per_day": "10", "accept_late": "48", "attempts": "5",
        "counts": "last", "hidden_items": ["closed", "angles"], "reason": "term begins",
    }  # fmt: skip
    answer = wang.post(PAGE, typed)
    assert answer.status_code == 303
    assert rules_of(services) == Rules(
        due=DUE,
        late=LateRule(kind="linear", per_day=0.1),
        accept_late_s=48 * 3600,
        attempts=5,
        counts=Counts.LAST,
        hidden_items=("closed", "angles"),
    )
    saved = wang.get(answer.headers["Location"]).text
    assert "Saved." in saved
    assert 'value="2026-03-20T23:59"' in saved
    assert len(re.findall(r'name="hidden_items" value="\w+" checked', saved)) == 2
    line = wang.get("/class/rules").text
    for words in ("2026-03-20 23:59", "−10 % a day", "accepted for 48 h", "the last"):
        assert words in line
    log = wang.get("/class/audit").text
    assert "term begins" in log
    assert "rules changed" in log
    assert "Accepted after due for: " in log
    assert "</span> 2 d</li>" in log
    assert 'href="/class/rules/square"' in log


def test_a_student_sees_when_it_is_due_and_what_lateness_leaves(
    browser: Browser, tokens: dict[str, str], services: Services, put: Callable[..., str]
) -> None:
    signed = Signature(services.clock(), "ros", "wang")
    rules = Rules(due=DUE, late=LateRule(kind="linear", per_day=0.1), accept_late_s=36 * 3600)
    services.rules.set("square", rules, signed)
    browser.get("/?lang=en")
    assert browser.enter(token=tokens["li"]).headers["Location"] == "/"
    due = browser.get("/assignments/square").text
    assert "<time>2026-03-20 23:59</time> <small>Asia/Shanghai</small>" in due  # not the clock of the browser
    assert "Lateness: −10 % a day, accepted for 36 h" in due
    assert "Due 2026-03-20 23:59" in browser.get("/").text
    handed_in = services.clock().astimezone(ZoneInfo("Asia/Shanghai"))
    result = put(student="li", course="ros")
    shown = browser.get(result).text
    assert "Handed in after" not in shown
    assert f"<time>{handed_in:%Y-%m-%d %H:%M}</time>" in shown
    assert "instants.js" not in shown
    assert "time zone, Asia/Shanghai." in shown
    earlier = replace(rules, due=services.clock() - timedelta(hours=25))
    services.rules.set("square", earlier, signed)
    assert "80 % is kept, 4 points" in browser.get(result).text
    services.rules.set("square", replace(rules, accept_late_s=0), signed)
    assert "Lateness: nothing is accepted after it is due" in browser.get("/assignments/square").text


def test_a_student_reads_beforehand_that_nothing_is_accepted(
    browser: Browser, tokens: dict[str, str], services: Services, put: Callable[..., str]
) -> None:
    signed, now = Signature(services.clock(), "ros", "wang"), services.clock()
    browser.get("/?lang=en")
    browser.enter(token=tokens["li"])
    closed = Rules(due=now - timedelta(hours=1), accept_late_s=0)
    for rules, told in (
        (closed, "The assignment is closed"),
        (Rules(opens=now + timedelta(hours=1)), "The assignment is not open yet"),
    ):
        services.rules.set("square", rules, signed)
        shown = browser.get("/assignments/square").text
        assert told in shown
        assert 'id="file"' not in shown
        assert "upload.js" not in shown
        assert (" (past)" in browser.get("/").text) == (rules is closed)
    services.rules.set("square", Rules(attempts=1), signed)
    assert 'id="file"' in browser.get("/assignments/square").text
    put(student="li", course="ros")
    assert "No attempts are left" in browser.get("/assignments/square").text
    services.rules.extend("square", "li", Extension(extra_attempts=1), signed)
    assert 'id="file"' in browser.get("/assignments/square").text


def test_wrong_rules_change_nothing_and_lose_nothing(wang: Browser, services: Services) -> None:
    typed = {"due": "2026-03-20T23:59", "late": "linear", "per_day": "a lot", "attempts": "5"}
    answer = wang.post(PAGE, typed)
    assert answer.status_code == 422
    assert rules_of(services) == NO_RULES
    assert 'role="alert">Not saved: 1 to correct below.' in answer.text
    field = re.search(r'<input id="per_day"[^>]*>', answer.text)
    assert field is not None
    assert 'aria-invalid="true" aria-describedby="per_day-error' in field[0]
    assert 'value="a lot"' in field[0]
    assert 'value="5"' in answer.text


def hidden(text: str, name: str) -> str:
    return re.findall(rf'name="{name}" value="([^"]*)"', text)[-1]


def test_rules_changed_meanwhile_are_not_lost(wang: Browser, services: Services) -> None:
    seen = re.findall(r'name="seen" value="(\w+)"', wang.get(PAGE).text)[0]
    theirs = Rules(attempts=7)
    services.rules.set("square", theirs, Signature(services.clock(), "ros", "ta"))
    mistyped = wang.post(PAGE, {"attempts": "x", "seen": seen}).text
    assert f'name="seen" value="{seen}"' in mistyped  # correcting a field is no look at the other's change
    answer = wang.post(PAGE, {"attempts": "5", "reason": "mine", "seen": seen})
    assert answer.status_code == 422
    assert rules_of(services) == theirs
    assert "somebody changed the rules meanwhile" in answer.text
    assert 'id="attempts" name="attempts" type="text" value="5"' in answer.text
    assert 'value="mine"' in answer.text
    again = re.findall(r'name="seen" value="(\w+)"', answer.text)[0]
    assert wang.post(PAGE, {"attempts": "5", "seen": again}).status_code == 303
    assert rules_of(services).attempts == 5


def test_an_extension_given_meanwhile_is_not_lost(wang: Browser, services: Services) -> None:
    seen = hidden(wang.get(PAGE).text, "seen")
    theirs = Extension(extra_attempts=3)
    services.rules.extend("square", "li", theirs, Signature(services.clock(), "ros", "ta"))
    given_ = {"student": "li", "extra_attempts": "1", "seen": seen, "seen_for": ""}
    answer = wang.post(PAGE + "/extensions", given_, page=PAGE)
    assert answer.status_code == 422
    assert "this student has another extension" in answer.text
    assert services.rules.of("ros").extension("square", "li") == theirs
    given_ |= {name: hidden(answer.text, name) for name in ("seen", "seen_for")}
    assert wang.post(PAGE + "/extensions", given_, page=PAGE).status_code == 303
    assert services.rules.of("ros").extension("square", "li") == Extension(extra_attempts=1)


def test_a_student_gets_more_and_it_is_taken_back(wang: Browser, services: Services) -> None:
    given_ = {"student": " li ", "due": "2026-03-27T23:59", "extra_attempts": "2", "reason": "ill"}
    answer = wang.post(PAGE + "/extensions", given_, page=PAGE)
    assert answer.status_code == 303
    extension = services.rules.of("ros").extension("square", "li")
    assert extension == Extension(due=datetime(2026, 3, 27, 15, 59, tzinfo=UTC), extra_attempts=2)
    page = wang.get(PAGE).text
    assert "2026-03-27 23:59" in page
    assert "+2" in page
    filled = wang.get(PAGE + "?student=li").text
    assert 'id="x-student" name="student" value="li"' in filled
    assert 'value="2026-03-27T23:59"' in filled
    wang.post(PAGE + "/extensions", {"student": "li"}, page=PAGE)
    assert services.rules.of("ros").extension("square", "li") == NO_EXTENSION
    assert "+2" not in wang.get(PAGE).text


@pytest.mark.parametrize(
    ("typed", "field"),
    [
        ({"student": "nobody"}, "x-student"),
        ({"student": "li", "due": "soon"}, "x-due"),
        ({"student": "li", "extra_attempts": "-1"}, "x-attempts"),
    ],
)
def test_a_wrong_extension_is_told_at_its_field(
    wang: Browser, services: Services, typed: dict[str, str], field: str
) -> None:
    answer = wang.post(PAGE + "/extensions", typed, page=PAGE)
    assert answer.status_code == 422
    assert f'id="{field}-error"' in answer.text
    assert re.search(rf'id="{field}"[^>]*aria-invalid="true"', answer.text)
    assert services.rules.of("ros").extensions == {}


def test_assistants_read_the_rules(browser: Browser, tokens: dict[str, str], services: Services) -> None:
    rules = Rules(due=DUE, hidden_items=("closed",))
    services.rules.set("square", rules, Signature(services.clock(), "ros", "wang"), "")
    browser.enter(token=tokens["ta"])
    text = browser.get(PAGE).text
    assert 'value="2026-03-20T23:59"' in text
    assert 'type="submit">保存规则' not in text
    assert browser.post(PAGE, {"attempts": "1"}).status_code == 403
    assert rules_of(services) == rules


def test_without_a_course_there_are_no_rules(instructor: Browser) -> None:
    assert "grader course create" in instructor.get("/class/rules").text
    assert "保存规则" not in instructor.get(PAGE).text
    assert instructor.post(PAGE, {"attempts": "1"}).status_code == 409


def test_a_section_gets_its_own_due_date_on_the_page(
    client: httpx.Client, tokens: dict[str, str], services: Services
) -> None:
    services.courses.import_roster("ros", [RosterEntry(id="li", name="", sections=("一班",))], "wang")
    wang = Browser(client)
    wang.enter(token=tokens["wang"])
    page = "/class/rules/square/section?name=一班"
    assert "一班" in wang.get("/class/rules/square").text
    typed = {"due": "2026-03-20T23:59", "late": "linear", "per_day": "10", "accept_late": "48"}
    assert wang.post(page, typed).headers["Location"] == "/class/rules/square?saved=rules#by-section"
    rules = services.rules.of("ros").of("square")
    (one,) = rules.by_section
    assert (one.section, one.late.per_day, one.accept_late_s, rules.due) == ("一班", 0.1, 172_800, None)
    assert services.rules.of("ros").of("square", "li").due == one.due
    assert "2026-03-20 23:59" in wang.get("/class/rules/square").text
    assert wang.post(page, {**typed, "due": ""}).status_code == 422
    wang.post("/class/rules/square", {"attempts": "3"})  # the other form leaves the sections alone
    assert services.rules.of("ros").of("square").by_section == (one,)
    wang.post(page, {"remove": "true"})
    assert services.rules.of("ros").of("square").by_section == ()
    assert "2026-03-20 23:59" in wang.get("/class/audit").text


def test_the_statistics_of_a_draft_are_not_linked(wang: Browser, services: Services) -> None:
    """They are nowhere: drafts have no column in the class."""
    for shown, status in ((Shown.ALWAYS, 200), (Shown.DRAFT, 404)):
        services.rules.set("square", Rules(shown=shown), Signature(DUE, "ros", "wang"))
        assert wang.get("/class/assignments/square").status_code == status
        assert ('href="/class/assignments/square"' in wang.get(PAGE).text) == (status == 200)
