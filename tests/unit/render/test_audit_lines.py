"""The audit log in words."""

import re
from dataclasses import asdict
from pathlib import Path
from typing import Any
from zoneinfo import ZoneInfo

import pytest

import grader.store
from grader.contracts.regrade import RegradeState
from grader.contracts.rules import LateKind
from grader.render.audit_lines import ACTIONS, Teller
from tests.fakes.late_rules import EXAMPLES

ZH, EN = (Teller(language, ZoneInfo("Asia/Shanghai")) for language in ("zh", "en"))


def test_every_action_of_the_store_has_words() -> None:
    folder = Path(grader.store.__file__).parent
    texts = [path.read_text(encoding="utf-8") for path in folder.rglob("*.py")]
    calls = [call for text in texts for call in re.findall(r"\brecord(?:_all)?\((.*?)\)", text, re.DOTALL)]
    named = {one for call in calls for one in re.findall(r"\"([a-z]+\.[a-z_]+)\"", call)}
    decided = {f"regrade.{one.value}" for one in RegradeState if one is not RegradeState.OPEN}
    assert {"rules.change", "grade.judge", "member.add"} <= named
    assert named | decided <= set(ACTIONS)


@pytest.mark.parametrize(
    ("name", "value", "zh", "en"),
    [
        ("accept_late_s", 172_800, "2 天", "2 d"),
        ("accept_late_s", 93_784, "1 天 2 小时 3 分钟 4 秒", "1 d 2 h 3 min 4 s"),
        ("accept_late_s", 0, "0 秒", "0 s"),
        ("accept_late_s", None, "—", "—"),
        ("due", "2026-03-20T15:59:00+00:00", "2026-03-20 23:59", "2026-03-20 23:59"),
        ("due", "whenever", "whenever", "whenever"),
        ("late", {"kind": "new"}, '{"kind": "new"}', '{"kind": "new"}'),
        ("counts", "last", "最后一次", "the last"),
        ("role", "assistant", "助教", "assistant"),
        ("hidden_items", ["a", "b"], "a, b", "a, b"),
        ("hidden_items", [], "—", "—"),
        ("by_section", [], "—", "—"),
        ("score", 12.0, "12", "12"),
    ],
)
def test_values_are_told_in_words(name: str, value: Any, zh: str, en: str) -> None:
    assert (ZH.value(name, value), EN.value(name, value)) == (zh, en)


LATE = {
    "none": ("不扣分", "costs nothing"),
    "linear": ("每天 −10 %", "−10 % a day"),
    "steps": (
        "迟交超过 1 小时 保留 90 %，迟交超过 2 小时 保留 50 %",
        "later than 1 h keeps 90 %, later than 2 h keeps 50 %",
    ),
}


@pytest.mark.parametrize("kind", EXAMPLES)
def test_every_late_rule_is_told_in_words(kind: LateKind) -> None:
    value = asdict(EXAMPLES[kind])
    assert (ZH.value("late", value), EN.value("late", value)) == LATE[kind]
    assert EN.late(value, in_full=False) != ""


def test_who_did_it_is_told() -> None:
    assert (ZH.actor("wang"), EN.actor("wang")) == ("wang", "wang")
    assert (ZH.actor("command line (li)"), EN.actor("command line (li)")) == (
        "命令行（li）",
        "command line (li)",
    )


def test_only_what_differs_is_told() -> None:
    assert EN.differences({"a": 1, "b": 2.0}, {"a": 1, "b": 3.5}) == [("b", "2", "3.5")]
    assert ZH.differences(None, {"name": "x"}) == [("姓名", "—", "x")]
    uploaded = {"version": 2, "size_bytes": 3088}
    assert ZH.differences(None, uploaded) == [("版本", "—", "2"), ("大小（字节）", "—", "3088")]
    assert EN.differences(None, "id") == [("", "—", "id")]
    assert EN.differences("x" * 1_000, None)[0][1].endswith("…")


def test_what_something_was_done_to() -> None:
    assert ZH.subject("assignment square, member li") == "作业 square，成员 li"
    assert ZH.subject("regrade 019 of square") == "作业 square 的重新评分 019"
    assert EN.subject("regrade 019 of square") == "re-grade 019 of square"
    assert EN.subject("something") == "something"
    assert EN.action("rules.change") == "rules changed"
    assert EN.action("new.thing") == "new.thing"
