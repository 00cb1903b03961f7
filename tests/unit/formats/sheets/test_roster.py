"""Class lists as registries, platforms and teachers save them; all names are invented."""

import io
import re
import zipfile
from collections.abc import Sequence
from pathlib import Path

import pytest
import xlsxwriter
from hypothesis import given
from hypothesis import strategies as st

from grader.contracts.errors import CourseError
from grader.contracts.identity import Role, RosterEntry
from grader.formats.sheets.reading import MAX_FILE_BYTES
from grader.formats.sheets.roster import read_roster

Rows = Sequence[Sequence[object]]
LI = ("2530123456", "李雷")
HAN = ("2530123457", "韩梅梅")


def entry(person: str, name: str = "x", role: Role | None = None) -> RosterEntry:
    return RosterEntry(id=person, name=name, role=role)


def workbook(*sheets: Rows, hidden: int | None = None, names: tuple[str | None, ...] = ()) -> bytes:
    out = io.BytesIO()
    with xlsxwriter.Workbook(out, {"in_memory": True}) as book:
        for index, rows in enumerate(sheets):
            sheet = book.add_worksheet(names[index] if names else None)
            for number, row in enumerate(rows):
                sheet.write_row(number, 0, row)
            if index == hidden:
                sheet.hide()
            else:
                sheet.activate()
    return out.getvalue()


def with_wrong_dimension(content: bytes) -> bytes:
    """The workbook as some registries write it: the sheet says that it has one cell."""
    out = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(content)) as before, zipfile.ZipFile(out, "w") as after:
        for name in before.namelist():
            text = before.read(name)
            if name.startswith("xl/worksheets/"):
                text, count = re.subn(rb'<dimension ref="[^"]*"/>', b'<dimension ref="A1"/>', text)
                assert count == 1
            after.writestr(name, text)
    return out.getvalue()


def csv(rows: Rows, separator: str = ",", encoding: str = "utf-8") -> bytes:
    return "".join(separator.join(map(str, row)) + "\r\n" for row in rows).encode(encoding)


PLAIN: Rows = [("学号", "姓名"), LI, HAN]
REGISTRY: Rows = [
    ("某某大学",), ("2026-2027 学年第一学期",), ("课程：机器人导论",), ("教师：王",),
    ("序号", "学号", "姓名", "行政班", "性别", "平时", ""),
    ("", "", "", "", "", "作业", "考勤"),
    (1, 2530123456, "李雷", "机器人2501", "男"),
    (2, 2530123457.0, "韩梅梅", "机器人2502", "女"),
    ("说明：缺考记为空白",),
]  # fmt: skip
PAPER: Rows = [
    ("第三周测验",),
    ("学号", "姓名", "进入考试时间", "得分 (总:10.0分)"),
    (*LI, "", 9),
    (*HAN, "", 8),
]
SUMMARY: Rows = [
    ("学号", "签到", "", "姓名", "签到方式"),
    ("", "次数", "率", "", "扫码"),
    (LI[0], 3, 1.0, LI[1], "扫码"),
    (HAN[0], 2, 0.5, HAN[1], "扫码"),
]
TRANSCRIPT: Rows = [
    ("成绩单",), ("导出时间 2026-11-01",), ("用户组", "学号", "姓名", "MOOCID", "总分(80.0)", "排名"),
    ("一班", LI[0], LI[1], "", "未开考", ""), ("二班", HAN[0], HAN[1], "", 70, 1),
]  # fmt: skip
CANVAS: Rows = [
    ("Student", "ID", "SIS User ID", "SIS Login ID", "Section"),
    ("    Points Possible", "", "", "", ""),
    (LI[1], 901, LI[0], "lilei", "A"),
    (HAN[1], 902, HAN[0], "hanmm", "B"),
]
GRADESCOPE: Rows = [
    ("First Name", "Last Name", "SID", "Email", "Sections", "Total Score"),
    ("雷", "李", LI[0], "li@example.com", "A", 5),
    ("梅梅", "韩", HAN[0], "", "B", 7),
]
LAYOUTS = [PLAIN, REGISTRY, PAPER, SUMMARY, TRANSCRIPT, CANVAS, GRADESCOPE]
NAMES = ["plain", "registry", "paper", "summary", "transcript", "canvas", "gradescope"]


@pytest.mark.parametrize("rows", LAYOUTS, ids=NAMES)
def test_every_layout_gives_the_same_people(rows: Rows) -> None:
    for content in (
        csv(rows, encoding="gbk"),
        csv(rows, "\t", "utf-16"),
        with_wrong_dimension(workbook(rows)),
    ):
        assert [(one.id, one.name) for one in read_roster(content).checked()] == [LI, HAN]


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "gbk", "utf-16", "utf-16-le", "utf-16-be"])
@pytest.mark.parametrize("separator", [",", ";", "\t", "，"])
def test_csv_comes_in_many_forms(encoding: str, separator: str) -> None:
    content = csv(
        [("学号", "姓名"), ("'20260001", "李雷"), ("20260002.0", "Han; Mei"[:3]), ('="00260003"', "王")],
        separator,
        encoding,
    )
    assert [one.id for one in read_roster(content).checked()] == ["20260001", "20260002", "00260003"]


def test_old_workbooks_are_read() -> None:
    content = (Path(__file__).parent / "files" / "roster.xls").read_bytes()
    found = read_roster(content).checked()
    assert [(one.id, one.name, one.sections) for one in found] == [
        (*LI, ("机器人2501",)),
        (*HAN, ("机器人2502",)),
    ]


def test_addresses_and_sections_are_kept() -> None:
    content = csv([("学号", "姓名", "邮箱", "班级"), (1, "a", "a@b.cn", "二班；一班"), (2, "b", "", "")])
    first, second = read_roster(content).checked()
    assert (first.email, first.sections) == ("a@b.cn", ("二班", "一班"))
    assert (second.email, second.sections) == (None, None)


def test_names_of_columns_may_be_widened_by_spaces() -> None:
    content = csv([("学 号", "姓\u3000 名", "行政班级", "角 色"), (*LI, "A班", "学生")])
    assert read_roster(content).checked()[0].sections == ("A班",)
    with pytest.raises(CourseError, match="no column"):
        read_roster(csv([("i d", "na me"), LI]))


def test_the_first_visible_sheet_with_both_columns_counts() -> None:
    other = [("学号", "姓名"), ("9", "x")]
    content = workbook(other, [("学号", "成绩"), ("8", "1")], PLAIN, PLAIN, hidden=0)
    assert [one.id for one in read_roster(content).checked()] == [LI[0], HAN[0]]


def test_a_workbook_may_have_a_sheet_for_each_section() -> None:
    """Teachers have one sheet for each class, and others with the same people's marks."""
    wang, zhao = ("20260003", "王"), ("20260004", "赵")
    marks = [("学号", "姓名", "成绩"), (*LI, 1), (*HAN, 2)]
    second = [("学号", "姓名", "班级"), (*wang, ""), (*LI, ""), (*zhao, "旁听"), ("合计", 2, "")]
    roster = read_roster(workbook(PLAIN, marks, second, names=("机器人2401", "成绩", "机器人2402")))
    assert [(one.id, one.sections) for one in roster.entries] == [
        (LI[0], ("机器人2401",)),
        (HAN[0], ("机器人2401",)),
        (wang[0], ("机器人2402",)),
        (zhao[0], ("旁听",)),
    ]
    (skipped,) = roster.skipped
    assert skipped.place.words.zh == "工作表“机器人2402”第 3 行"
    assert skipped.reason.zh == f"工作表“机器人2401”第 2 行已经有 {LI[0]}"


def test_a_sheet_may_be_named_after_a_role_or_not_at_all() -> None:
    assistants = [("工号", "姓名"), ("ta1", "助教一")]
    roster = read_roster(workbook(PLAIN, assistants, names=("Sheet1", "助教")))
    assert [(one.role, one.sections) for one in roster.checked()] == [
        (None, None),
        (None, None),
        (Role.ASSISTANT, None),
    ]


def test_somebody_who_is_only_among_the_marks_is_told() -> None:
    marks = [("学号", "姓名", "成绩"), (*LI, 1), (*HAN, 2), ("9", "x", 3)]
    roster = read_roster(workbook(PLAIN, marks, names=("名单", "成绩")))
    assert [one.id for one in roster.entries] == [LI[0], HAN[0]]
    (skipped,) = roster.skipped
    assert skipped.reason.en.endswith("such as 9 (1 in all): add them to the list there")


@pytest.mark.parametrize("written", ["欧\u3000阳文", "欧 阳\u3000文", "\u3000欧阳文 "])
def test_names_are_kept_without_the_spaces_that_widen_them(written: str) -> None:
    assert read_roster(csv([("学号", "姓名"), (1, written)])).checked()[0].name == "欧阳文"
    assert read_roster(csv([("学号", "姓名"), (1, "Ann\u3000Li")])).checked()[0].name == "Ann Li"


@pytest.mark.parametrize(
    ("first", "last", "name"),
    [("Jörg", "Müller", "Jörg Müller"), ("Ann", "Li", "Ann Li"), ("雷", "李", "李雷"), ("", "Ōno", "Ōno")],
)
def test_only_names_in_chinese_characters_begin_with_the_last_name(first: str, last: str, name: str) -> None:
    rows = [("SID", "First Name", "Last Name"), ("1", first, last)]
    assert read_roster(csv(rows)).checked()[0].name == name


def test_what_cannot_be_seen_in_a_cell_is_dropped() -> None:
    rows = [("学号", "姓名"), (f"\u200b{LI[0]}\ufeff", "李\u200b雷\u00a0")]
    for content in (csv(rows), workbook(rows)):
        assert [(one.id, one.name) for one in read_roster(content).checked()] == [LI]


def test_columns_and_roles_may_have_their_chinese_names() -> None:
    content = "学号,姓名,角色\n1,李雷,学生\n2,助教一,助教\n3,王,\n4,赵,老师\n".encode()
    assert [(one.id, one.role) for one in read_roster(content).checked()] == [
        ("1", Role.STUDENT),
        ("2", Role.ASSISTANT),
        ("3", None),
        ("4", Role.INSTRUCTOR),
    ]


def test_a_roster_needs_no_roles_and_minds_no_other_columns() -> None:
    assert read_roster(b'Name , ID,class\n"Li, Lei",1,3\n').checked() == (entry("1", "Li, Lei"),)


def test_the_sum_of_a_list_is_no_student() -> None:
    roster = read_roster(
        workbook([("序号", *PLAIN[0]), (1, *LI), (2, *HAN), ("合计", 2, ""), ("", "人数：", 2)])
    )
    assert [one.id for one in roster.checked()] == [LI[0], HAN[0]]
    of_a_platform = [PLAIN[0], LI, ("合计", "80人"), ("合计 80 人", "")]
    assert [one.id for one in read_roster(csv(of_a_platform)).checked()] == [LI[0]]


@pytest.mark.parametrize("header", ["id,name", "学号,姓名"])
def test_the_header_of_the_next_page_is_no_student(header: str) -> None:
    roster = read_roster(f"{header}\n1001,张三\n\n{header}\n1002,李四\n".encode())
    assert [one.id for one in roster.checked()] == ["1001", "1002"]


def test_a_student_may_be_called_sum() -> None:
    assert read_roster(b"id,name,section\nsum,Sum,total\n1,a,1\n").checked()[0].id == "sum"


def test_lines_without_anybody_are_skipped() -> None:
    content = b"id,name,role\r\n,,\r\n\r\n1,a,\r\n , ,\r\n,,,,\r\n"
    assert read_roster(content).checked() == (entry("1", "a"),)


@pytest.mark.parametrize(
    ("rows", "number", "why"),
    [
        ([("学号", "姓名"), (1, "a"), ("2.02601E+07", "b")], 3, "spreadsheet shortened"),
        ([("学号", "姓名"), (1, "a"), (1234567890123456789, "b")], 3, "spreadsheet shortened"),
        ([("学号", "姓名"), ("S001", "a"), ("s001", "b")], 3, "upper and lower case"),
        ([("学号", "姓名"), ("S001", "a"), ("S001", "b")], 3, "S001 a stands in line 2 already"),
        ([("学号", "姓名"), ("0012345", "a"), ("12345", "b")], 3, "only in zeros at its beginning"),
        ([("学号", "姓名"), (1, "a"), ("", "b")], 3, "no id"),
        ([("学号", "姓名"), (1, "a"), ("请假", "b")], 3, "is no id"),
        ([("学号", "姓名", "角色"), (1, "a", ""), (2, "b", "king")], 3, "no role"),
        ([("学号", "姓名", "邮箱"), (1, "a", ""), (2, "b", "at home")], 3, "e-mail"),
        ([("学号", "姓名", "班级"), (1, "a", ""), (2, "b", "x" * 65)], 3, "no section"),
    ],
)
def test_a_wrong_row_is_named_and_the_others_are_kept(rows: Rows, number: int, why: str) -> None:
    roster = read_roster(workbook(rows))
    assert [one.place.number for one in roster.skipped] == [number]
    assert why in roster.skipped[0].reason.en
    assert len(roster.entries) == 1
    with pytest.raises(CourseError, match=f"nothing was imported:\nline {number}: "):
        roster.checked()


@pytest.mark.parametrize(
    ("written", "role"),
    [
        ("TA", Role.ASSISTANT),
        ("Teaching Assistant", Role.ASSISTANT),
        ("Teacher", Role.INSTRUCTOR),
        ("Student", Role.STUDENT),
    ],
)
def test_roles_may_be_named_as_platforms_name_them(written: str, role: Role) -> None:
    assert read_roster(f"id,name,role\nx1,Smith,{written}\n".encode()).entries[0].role is role


def test_what_is_wrong_with_a_roster_is_told_in_its_own_words() -> None:
    with pytest.raises(CourseError) as caught:
        read_roster("姓名\n李雷\n".encode())
    assert "“学号”" in caught.value.message_in("zh")
    assert "学生、助教、教师" in read_roster("学号,姓名,角色\n1,李雷,班长\n".encode()).skipped[0].reason.zh


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (b"", "no column"),
        (b"id\n1\n", "no column"),
        (b"id,name,id\n1,a,2\n", "two columns"),
        (b"id,name\n", "nobody"),
        (b"id,name\n1,\xff\xff\n", "line 2: neither UTF-8"),
        (b'id,name\n1,"a\n2,b\n3,c\n', "line 2: its quotation marks do not match"),
        (b'id,name\n1,a\n2,"b"c\n', "line 3: its quotation marks do not match"),
        (b"PK\x03\x04 no zip", "damaged"),
        (b"\xef\xbb\xbf\n<html><table><tr><td>id</td></tr></table>", "no workbook"),
        (b"%PDF-1.7\n", "no workbook"),
        (b"\xd0\xcf\x11\xe0" + bytes(600), "damaged"),
        (workbook([]), "no column"),
        (bytes(MAX_FILE_BYTES + 1), "more than 4 MiB"),
    ],
)
def test_a_file_that_is_no_roster(content: bytes, why: str) -> None:
    with pytest.raises(CourseError, match=why):
        read_roster(content)


def test_a_workbook_larger_than_a_class_is_refused() -> None:
    with pytest.raises(CourseError, match="too large"):
        read_roster(workbook([*PLAIN, *[("",)] * 20_000, ("x",)]))
    bomb = io.BytesIO()
    with zipfile.ZipFile(bomb, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("xl/workbook.xml", bytes(65 * 1024 * 1024))
    with pytest.raises(CourseError, match="too large"):
        read_roster(bomb.getvalue())


@pytest.mark.parametrize(
    "text",
    [
        "学号,姓名\n" + "".join(f"s{i},某\n" for i in range(20_000)),
        "学号,姓名\n" + "," * 300,
        "学号,姓名\n" + ("x" + "," * 200 + "\n") * 2_000,
    ],
)
def test_csv_is_bounded_as_workbooks_are(text: str) -> None:
    with pytest.raises(CourseError, match="too large"):
        read_roster(text.encode())


def test_a_small_workbook_that_says_one_long_text_everywhere_is_refused() -> None:
    """It would be a hundred times as large in memory, here as well as in the process that reads it."""
    content = workbook([*PLAIN, *[("A" * 2_000,) * 100] * 100])
    assert len(content) < 100 * 1024
    with pytest.raises(CourseError, match="too large"):
        read_roster(content)


@given(st.binary(max_size=200) | st.text(max_size=200).map(lambda text: ("id,name\n" + text).encode()))
def test_any_roster_is_read_or_refused(content: bytes) -> None:
    try:
        roster = read_roster(content)
    except CourseError:
        return
    ids = [one.id for one in roster.entries]
    assert len(set(ids)) == len(ids)
    assert roster.entries or roster.skipped
