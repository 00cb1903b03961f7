"""The people of a course, on the pages of an instructor."""

import html
import re
from collections.abc import Callable

import httpx
import pytest

from grader.contracts.identity import Role
from grader.use_cases.services import Services
from tests.unit.service.web.conftest import Browser

LIST = "课程名单\n学号,姓名,班级,邮箱\nli,李雷,一班,li@a.cn\n\nzhou,周,二班；一班,\nli,又来,,\n".encode("gbk")


@pytest.fixture
def wang(client: httpx.Client, tokens: dict[str, str]) -> Browser:
    browser = Browser(client)
    assert browser.enter(token=tokens["wang"]).status_code == 303
    return browser


def field(page: httpx.Response, name: str) -> str:
    return html.unescape(re.search(rf'name="{name}" value="([^"]*)"', page.text)[1])


def test_a_list_is_seen_before_it_is_imported(wang: Browser, services: Services) -> None:
    before = services.courses.members("ros")
    preview = wang.post(
        "/class/people/preview", {}, files={"file": ("class.csv", LIST)}, page="/class/people"
    )
    assert services.courses.members("ros") == before
    for text in (
        "将新增 1 人",
        "zhou",
        "将修改 1 人",
        "原来：—",
        "第 3 行已经有 li",
        "名单里没有的学生：1 人",
        "han",
    ):
        assert text in preview.text, text
    confirmed = {"entries": field(preview, "entries"), "seen": field(preview, "seen")}
    answer = wang.post("/class/people/import", confirmed, page="/class/people")
    assert answer.headers["Location"] == "/class/people?done=imported&added=1&changed=1"
    zhou = services.courses.member("ros", "zhou")
    assert (zhou.name, zhou.role, zhou.sections) == ("周", Role.STUDENT, ("一班", "二班"))
    assert services.courses.member("ros", "han") is not None
    shown = wang.get("/class/people?section=二班").text
    assert "zhou" in shown
    assert "li@a.cn" not in shown


def test_who_is_gone_is_removed_only_if_asked(wang: Browser, services: Services) -> None:
    preview = wang.post(
        "/class/people/preview", {}, files={"file": ("class.csv", LIST)}, page="/class/people"
    )
    confirmed = {"entries": field(preview, "entries"), "seen": field(preview, "seen"), "remove": "true"}
    wang.post("/class/people/import", confirmed, page="/class/people")
    assert [one.id for one in services.courses.members("ros", Role.STUDENT)] == ["li", "zhou"]
    again = wang.post("/class/people/import", confirmed, page="/class/people")
    assert "刚被别人改过" in again.text  # another plan than the one that was seen


@pytest.mark.parametrize(
    ("content", "told"),
    [(b"", "找不到列名"), (b"PK\x03\x04", "损坏")],
)
def test_a_list_that_cannot_be_imported(wang: Browser, content: bytes, told: str) -> None:
    answer = wang.post(
        "/class/people/preview", {}, files={"file": ("class.csv", content)}, page="/class/people"
    )
    assert answer.status_code == 422
    assert told in answer.text


def test_a_row_that_clashes_with_a_member_is_skipped_and_whoever_returns_is_told(
    wang: Browser, services: Services
) -> None:
    services.courses.remove("ros", ["han"], "wang")
    content = "学号,姓名\nLI,李\nhan,韩\n".encode()
    preview = wang.post(
        "/class/people/preview", {}, files={"file": ("class.csv", content)}, page="/class/people"
    )
    assert "LI 和已有的成员 li 只有大小写不同" in preview.text
    assert "旧令牌已失效" in preview.text
    confirmed = {"entries": field(preview, "entries"), "seen": field(preview, "seen")}
    assert wang.post("/class/people/import", confirmed, page="/class/people").status_code == 303
    assert services.courses.member("ros", "LI") is None
    assert "没有有效令牌的：" in wang.get("/class/people?done=imported").text


def test_a_member_is_added_changed_and_removed(wang: Browser, services: Services) -> None:
    new = {"person": "zhao", "name": "赵", "role": "assistant", "sections": "一班，二班", "email": "z@a.cn"}
    assert wang.post("/class/people", new).headers["Location"] == "/class/people?done=saved"
    zhao = services.courses.member("ros", "zhao")
    assert (zhao.role, zhao.sections, zhao.email) == (Role.ASSISTANT, ("一班", "二班"), "z@a.cn")
    changed = {"name": "赵云", "role": "student", "sections": "", "email": ""}
    assert wang.post("/class/people/zhao", changed).status_code == 303
    zhao = services.courses.member("ros", "zhao")
    assert (zhao.name, zhao.role, zhao.sections, zhao.email) == ("赵云", Role.STUDENT, (), "")
    gone = wang.post("/class/people/zhao/remove", {"reason": "退课"}, page="/class/people/zhao")
    assert gone.headers["Location"] == "/class/people?done=removed"
    assert services.courses.member("ros", "zhao") is None
    assert wang.get("/class/people/zhao").status_code == 404


def test_adding_changes_nobody_who_is_there(wang: Browser, services: Services) -> None:
    before = services.courses.member("ros", "ta")
    refused = wang.post("/class/people", {"person": "ta", "name": "New"})
    assert (refused.status_code, "已经有成员 ta" in refused.text) == (422, True)
    assert services.courses.member("ros", "ta") == before


def test_what_is_wrong_stands_in_the_form(wang: Browser, services: Services) -> None:
    wrong = wang.post("/class/people", {"person": "a b", "name": "赵"})
    assert wrong.status_code == 422
    assert "不能用作编号" in wrong.text
    assert 'value="a b"' in wrong.text
    wrong = wang.post("/class/people/li", {"name": "李", "email": "here"})
    assert "不是邮箱地址" in wrong.text
    last = wang.post("/class/people/wang/remove", {}, page="/class/people/wang")
    assert "没有教师了" in last.text
    assert services.courses.member("ros", "wang") is not None


def test_a_token_is_shown_once_and_opens_the_pages(wang: Browser) -> None:
    assert "lang=en" in wang.get("/class/people/li").text
    made = wang.post("/class/people/li/token", {}, page="/class/people/li")
    assert "lang=en" not in made.text  # nothing answers to GET there, and the token would be gone
    token = re.search(r"<code>(.+)</code>", made.text)[1]
    assert made.text.count("<svg") == 1  # the code of the link
    assert token not in wang.get("/class/people/li").text
    wang.enter(token=token)
    assert ">li</span>" in wang.get("/submissions").text


def test_who_has_no_token_gets_one_on_a_slip_or_in_a_table(
    wang: Browser, services: Services, put: Callable[..., str]
) -> None:
    for person, name in (("zhou", "周"), ("zhu", "=HYPERLINK(1)")):
        wang.post("/class/people", {"person": person, "name": name})
    table = wang.post("/class/people/tokens", {"form": "csv"}, page="/class/people")
    lines = table.text.removeprefix("\ufeff").splitlines()
    assert [line.split(",")[:2] for line in lines] == [
        ["id", "name"],
        ["zhou", "周"],
        ["zhu", "'=HYPERLINK(1)"],
    ]
    nobody = wang.post("/class/people/tokens", {"form": "sheet"}, page="/class/people")
    assert nobody.headers["Location"] == "/class/people?done=none_missing"
    wang.post("/class/people", {"person": "sun", "name": "孙"})
    slips = wang.post("/class/people/tokens", {"form": "sheet"}, page="/class/people").text
    assert "sun 孙" in slips
    assert slips.count("<svg") == slips.count("<code>") == 1


def test_slips_for_a_section_whose_people_have_tokens_already(wang: Browser, services: Services) -> None:
    for person, section in (("zhou", "A"), ("zhu", "A"), ("sun", "B")):
        wang.post("/class/people", {"person": person, "name": person, "sections": section})
    wang.post("/class/people/tokens", {"form": "csv"}, page="/class/people")
    none = wang.post("/class/people/tokens", {"form": "sheet", "section": "A"}, page="/class/people")
    assert none.headers["Location"] == "/class/people?done=none_missing"
    wanted = {"form": "sheet", "section": "A", "everybody": "true"}
    slips = wang.post("/class/people/tokens", wanted, page="/class/people").text
    assert re.findall(r"<strong>(\w+)", slips) == ["zhou", "zhu"]
    token = re.search(r"<code>(.+)</code>", slips)[1]
    wang.enter(token=token)
    assert ">zhou</span>" in wang.get("/submissions").text


def test_ids_that_lost_a_zero_are_restored_by_address_or_name(wang: Browser, services: Services) -> None:
    wang.post("/class/people", {"person": "024120705", "name": "郭霞"})
    wang.post("/class/people", {"person": "024120905", "name": "欧阳文"})
    listed = (
        "学号,姓名,邮箱\n24120705,郭霞,\n24130000,新来的,024130000@stu.example.edu.cn\n24120905,别人,\n"
    ).encode()
    shown = wang.post(
        "/class/people/preview", {}, files={"file": ("a.csv", listed)}, page="/class/people"
    ).text
    restored = re.findall(r"<li>(.*?) → <strong>(\d+)</strong>", shown)
    assert [(row.split("：")[-1].split(": ")[-1], id_) for row, id_ in restored] == [
        ("24120705", "024120705"),
        ("24130000", "024130000"),
    ]
    assert "024120905" in shown  # another name: a wrong row
    assert 'name="remove"' not in shown  # somebody of the wrong rows may be among those who are not listed
    fields = {name: re.search(rf'name="{name}" value="([^"]*)"', shown)[1] for name in ("entries", "seen")}
    done = wang.post("/class/people/import", fields, page="/class/people")
    assert done.headers["Location"] == "/class/people?done=imported&added=1&changed=0"
    people = {one.id for one in services.courses.members("ros")}
    assert {"024120705", "024130000"} <= people
    assert not {"24120705", "24130000"} & people
