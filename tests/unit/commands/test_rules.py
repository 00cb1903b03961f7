"""`grader rules`, as typed: what is named changes, the rest stays, and both are shown."""

import json
from collections.abc import Iterator

import pytest

from grader.catalog import Catalog
from grader.commands import cli
from grader.contracts.identity import Role, RosterEntry
from grader.contracts.rules import Extension, Rules
from grader.store.audit import Signature
from grader.store.clock import utc_now
from grader.store.courses import Courses
from grader.store.database import Database
from grader.store.rules import StoredRules


@pytest.fixture
def database(sqlite_url: str) -> Iterator[Database]:
    """A database with a course and two students."""
    opened = Database(sqlite_url)
    courses = Courses(opened, utc_now)
    courses.create("ros", "ROS", "Asia/Shanghai", "test")
    courses.import_roster("ros", [RosterEntry(id=one, name=one, role=Role.STUDENT) for one in "12"], "test")
    yield opened
    opened.close()


@pytest.fixture
def grader(
    database: Database,
    sqlite_url: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
):
    monkeypatch.setenv("GRADER_DATABASE_URL", sqlite_url)

    def run(*arguments: str, status: int = 0, lang: str = "en") -> tuple[str, str]:
        assert cli.run([*arguments, "--lang", lang]) == status
        return capsys.readouterr()

    return run


@pytest.fixture
def shown(grader):
    return lambda: json.loads(grader("rules", "show", "--json")[0])


def test_what_is_named_changes_and_the_rest_stays(grader, shown) -> None:
    grader("rules", "set", "square", "due=2026-03-20T23:59:59", "attempts=5")
    told = grader("rules", "set", "square", 'late={"kind": "linear", "per_day": 0.1}', "attempts=none")[1]
    assert told.splitlines() == [
        "square: changed",
        "  late             costs nothing → −10 % a day",
        "  attempts         5 → —",
    ]
    rules = shown()["square"]
    assert rules["due"] == "2026-03-20T23:59:59+08:00"
    assert (rules["late"]["per_day"], rules["attempts"]) == (0.1, None)
    assert grader("rules", "set", "square", "attempts=none", lang="zh")[1] == "square: 没有变化\n"


def test_rules_are_shown_in_words(grader) -> None:
    grader(
        "rules",
        "set",
        "square",
        "due=2026-03-20T23:59:59",
        "attempts=5",
        'late={"kind":"linear","per_day":0.1}',
    )
    grader("rules", "set", "hello", "shown=draft")
    assert grader("rules", "show")[0].splitlines() == [
        "hello\tshown: never (draft)",
        "square\tdue: 2026-03-20 23:59:59; late: −10 % a day; attempts: 5",
    ]


def test_several_assignments_at_once(grader, shown) -> None:
    heading, *fields = grader("rules", "set", "all", "shown=draft")[1].splitlines()
    count = len(Catalog().all())
    assert heading == f"{count} assignments (hello … theory_balance): changed"
    assert fields == ["  shown            always → never (draft)"]
    grader("rules", "set", "square, hello", "shown=always", "attempts=5")
    rules = shown()
    assert rules["pentagon"]["shown"] == "draft"
    assert [(rules[one]["shown"], rules[one]["attempts"]) for one in ("square", "hello")] == [
        ("always", 5)
    ] * 2


def test_nothing_changes_unless_all_can(grader, shown) -> None:
    grader("rules", "set", "square,hello", "hidden_items=sides", status=2)
    grader("rules", "set", "square,sqare", "attempts=5", status=2)
    assert shown() == {}


def test_a_dry_run_shows_and_changes_nothing(grader, shown) -> None:
    told = grader("rules", "set", "square", "due=2026-03-20T23:59:59", "--dry-run", lang="zh")[1]
    assert "什么也没改" in told
    assert "— → 2026-03-20 23:59:59" in told
    grader("rules", "extend", "1", "square", "--extra-attempts", "2", "--dry-run")
    assert shown() == {}


def test_an_extension_changes_only_what_is_named(grader, shown) -> None:
    extend = ("rules", "extend", "1", "square")
    grader(*extend, "--extra-attempts", "2")
    told = grader(*extend, "--due", "2026-03-27T23:59:59", "--reason", "ill")[1]
    assert told.splitlines()[:2] == ["square, 1: changed", "  due              — → 2026-03-27 23:59:59"]
    given = {"due": "2026-03-27T23:59:59+08:00", "extra_attempts": 2}
    assert shown()["square"]["extensions"] == {"1": given}
    grader(*extend, "--due", "none", "--extra-attempts", "0")
    assert "square" not in shown()


def test_several_students_are_extended_at_once(database: Database, grader, shown) -> None:
    Courses(database, utc_now).import_roster("ros", [RosterEntry(id="2", name="2")], "test")
    grader("rules", "extend", "1, 2", "square", "--extra-attempts", "2")
    assert sorted(shown()["square"]["extensions"]) == ["1", "2"]


def test_what_is_no_number_is_told_in_words(grader, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        grader("rules", "extend", "1", "square", "--extra-attempts", "two")
    assert "'two' will not do: write a whole number" in capsys.readouterr().err


def test_a_section_that_nobody_is_in_is_told(database: Database, grader) -> None:
    """Its name may be misspelt; it may also be filled later."""
    Courses(database, utc_now).import_roster("ros", [RosterEntry(id="2", name="2", sections=("A",))], "test")
    rules = [{"section": one, "due": "2026-03-20T00:00:00"} for one in ("A", "a")]
    told = grader("rules", "set", "square", "due=2026-03-20T00:00:00", f"by_section={json.dumps(rules)}")[1]
    assert told.splitlines()[-1] == "note: nobody is in the section a"
    assert "note" not in grader("rules", "set", "square", "attempts=5")[1]


def test_the_same_due_date_on_another_clock_is_no_change(grader) -> None:
    extend = ("rules", "extend", "1", "square", "--due", "2026-03-27T23:59:59")
    grader("rules", "set", "square", "due=2026-03-20T23:59:59")
    grader(*extend)
    assert grader(*extend)[1].splitlines()[0] == "square, 1: nothing changes"


def test_an_extension_without_effect_is_told(grader) -> None:
    grader("rules", "set", "square", "due=2026-03-20T23:59:59")
    told = grader("rules", "extend", "1", "square", "--due", "2026-03-19T23:59:59", lang="zh")[1]
    assert "没有作用" in told


@pytest.mark.parametrize("action", ["set", "extend"])
def test_what_somebody_else_changes_meanwhile_stays(
    grader, shown, database: Database, monkeypatch: pytest.MonkeyPatch, action: str
) -> None:
    of = StoredRules.of

    def then_somebody_else(self: StoredRules, course: str | None):
        before = of(self, course)
        signed = Signature(utc_now(), "ros", "wang")
        StoredRules(database).set("square", Rules(attempts=9), signed)
        StoredRules(database).extend("square", "1", Extension(extra_attempts=9), signed)
        return before

    change = {"set": ("square", "attempts=2"), "extend": ("1", "square", "--extra-attempts", "2")}[action]
    with monkeypatch.context() as patched:
        patched.setattr(StoredRules, "of", then_somebody_else)
        assert "刚刚有人改过" in grader("rules", action, *change, status=2, lang="zh")[1]
    assert (shown()["square"]["attempts"], shown()["square"]["extensions"]["1"]["extra_attempts"]) == (9, 9)


@pytest.mark.parametrize(
    ("rule", "zh", "en"),
    [
        ("attempts=many", "不是数字或 JSON；例如 attempts=3", "not a number or JSON; write"),
        ("late=linear", '\'late={"kind":"linear"', '\'late={"kind":"linear"'),
        ("attempts=1_0", "不是数字或 JSON", "not a number or JSON"),
        ('attempts="10"', "要填一个整数", "not a whole number"),
        ("attempts=2.5", "要填一个整数", "not a whole number"),
        ("attempts=0", "不能小于 1", "1 or more"),
        ("accept_late_s=NaN", "要填一个", "number"),
        ("due=tomorrow", "要填一个时间", "date and time"),
        ("due=2026-03-20", "要填一个时间", "date and time"),
        ("counts=best_before_due", "要有 due", "needs a due date"),
        ("atempts=3", "是不是 attempts？", "do you mean attempts?"),
        ("by_section=A", 'by_section=[{"section":"A"', 'by_section=[{"section":"A"'),
        ("colour=red", "写成 规则=值", "RULE=VALUE"),
        ("late=[1]", "JSON 对象", "JSON object"),
        ("attempts=3 attempts=4", "写了两次", "is given twice"),
        ("hidden_items=nose", "没有评分项 nose", "no item nose"),
    ],
)
def test_rules_that_make_no_sense_change_nothing(grader, shown, rule: str, zh: str, en: str) -> None:
    for language, words in (("zh", zh), ("en", en)):
        told = grader("rules", "set", "square", *rule.split(" "), status=2, lang=language)[1]
        assert told.startswith("grader: ")
        assert words in told
    assert shown() == {}


@pytest.mark.parametrize(
    ("arguments", "zh"),
    [
        (("9", "square", "--extra-attempts", "1"), "没有成员 9"),
        (("1,9,8", "square", "--extra-attempts", "1"), "没有成员 9, 8"),
        (("1", "spiral", "--extra-attempts", "1"), "没有作业"),
        (("1", "square"), "请给出 --due 或 --extra-attempts"),
        (("1", "square", "--due", "soon"), "要填一个时间"),
        (("1", "square", "--due", "9999-01-01T00:00"), "年份"),
        (("1", "square", "--extra-attempts", "-1"), "不能小于 0"),
    ],
)
def test_extensions_that_make_no_sense(grader, shown, arguments: tuple[str, ...], zh: str) -> None:
    assert zh in grader("rules", "extend", *arguments, status=2, lang="zh")[1]
    assert shown() == {}


def test_a_due_date_that_changes_nothing_is_told(database: Database, grader) -> None:
    early, late = "2026-03-20T00:00:00", "2026-03-30T00:00:00"
    between = "2026-03-25T00:00:00"
    assert "no due date" in grader("rules", "extend", "1", "square", "--due", between)[1]
    grader("rules", "set", "square", f"due={late}", f'by_section=[{{"section": "A", "due": "{early}"}}]')
    assert "no later than" in grader("rules", "extend", "1", "square", "--due", between, "--reason", "x")[1]
    Courses(database, utc_now).import_roster("ros", [RosterEntry(id="2", name="2", sections=("A",))], "test")
    assert "note" not in grader("rules", "extend", "2", "square", "--due", between)[1]
