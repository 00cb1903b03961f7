"""Points filled into sheets as registries and platforms hand them out; all names are invented."""

import io
import zipfile
from pathlib import Path

import openpyxl
import pytest
from openpyxl.styles import Font
from python_calamine import CalamineWorkbook

from grader.contracts.errors import CourseError
from grader.formats.sheets.filling import FilledSheet, NoColumnError, fill
from tests.unit.formats.sheets.test_roster import (
    HAN,
    LI,
    PAPER,
    REGISTRY,
    csv,
    with_wrong_dimension,
    workbook,
)

POINTS = {LI[0]: 87.5, HAN[0]: None, "x": 1.0}


def rows(sheet: FilledSheet) -> list[list[object]]:
    return CalamineWorkbook.from_filelike(io.BytesIO(sheet.content)).get_sheet_by_index(0).to_python()


def test_a_column_in_the_sub_header_is_filled_and_the_rest_stays() -> None:
    before = [[*row, *[""] * (7 - len(row))] for row in REGISTRY]
    filled = fill(with_wrong_dimension(workbook(REGISTRY)), ["作业"], POINTS)
    assert (filled.filled, filled.unknown) == (1, ())
    after = rows(filled)
    assert after[6][5] == 87.5
    after[6][5] = ""
    assert [[str(cell).removesuffix(".0") for cell in row] for row in after] == [
        [str(cell).removesuffix(".0") for cell in row] for row in before
    ]


def test_ids_match_however_they_are_written() -> None:
    content = csv([("学号", "成绩"), ("２５３０１２３４５６", ""), ("2530123457.0", "5"), ("99", "7")])
    filled = fill(content, [" 成绩："], POINTS)
    assert [row[1] for row in rows(filled)] == ["成绩", 87.5, 5.0, 7.0]
    assert filled.filled == 1
    assert [(row.number, row.person) for row in filled.unknown] == [(4, "99")]


def test_old_workbooks_come_back_as_new_ones() -> None:
    content = (Path(__file__).parent / "files" / "roster.xls").read_bytes()
    assert rows(fill(content, ["行政班"], POINTS))[2][3] == 87.5


def test_ids_keep_their_zeros_and_text_is_never_a_formula() -> None:
    content = csv([("学号", "备注", "成绩"), ("007", "=1+1", "")])
    assert rows(fill(content, ["成绩"], {"007": 1.0}))[1] == ["007", "=1+1", 1.0]


def test_a_line_break_in_a_cell_begins_no_row() -> None:
    content = csv([("学号", "备注", "成绩"), ("1", '"a\nb"', ""), ("2", "", "")])
    filled = rows(fill(content, ["成绩"], {"1": 1.0, "2": 2.0}))
    assert [row[2] for row in filled] == ["成绩", 1.0, 2.0]


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (csv(PAPER), r"no column '总评'; there are: 姓名, 进入考试时间"),
        (csv([("姓名", "成绩"), ("李", "")]), "no column of ids"),
        (b"", "no column of ids"),
    ],
)
def test_what_cannot_be_filled_says_what_is_there(content: bytes, why: str) -> None:
    with pytest.raises(CourseError, match=why):
        fill(content, ["总评"], POINTS)


def test_every_sheet_is_filled_and_those_without_the_column_stay() -> None:
    """Teachers have one sheet for each class."""
    sheets = (
        [("学号", "姓名", "成绩"), (*LI, "")],
        [("说明",), ("没有学号",)],
        [("学号", "成绩"), ("x", ""), ("y", 5)],
        [("学号", "备注"), ("x", 7)],
    )
    filled = fill(workbook(*sheets), ["成绩"], POINTS)
    book = CalamineWorkbook.from_filelike(io.BytesIO(filled.content))
    assert [book.get_sheet_by_index(number).to_python() for number in range(len(book.sheet_names))] == [
        [["学号", "姓名", "成绩"], [*LI, 87.5]],
        [["说明"], ["没有学号"]],
        [["学号", "成绩"], ["x", 1.0], ["y", 5.0]],
        [["学号", "备注"], ["x", 7.0]],
    ]
    assert filled.filled == 2
    assert [(row.sheet, row.person) for row in filled.unknown] == [(book.sheet_names[2], "y")]


def own_sheet() -> bytes:
    """A teacher's book: a merged title, ids of which spreadsheets made numbers, sums, a second sheet."""
    book = openpyxl.Workbook()
    sheet = book.active
    sheet.title = "平时成绩"
    sheet.append(["机器人操作系统 平时成绩登记表"])
    sheet.merge_cells("A1:F1")
    sheet["A1"].font = Font(bold=True, size=16)
    sheet.append(["序号", "学号", "姓名", "考勤", "正方形", "总评"])
    for number, person in enumerate([23100001, "024100101", "s77", 7, "2.41001E+08"], 1):
        sheet.append([number, person, "某某", 80 + number, None, f"=D{number + 2}+E{number + 2}"])
    sheet.column_dimensions["C"].width = 31.0
    sheet["E3"].number_format = "@"
    book.create_sheet("说明").append(["=1+1", "不要改"])
    out = io.BytesIO()
    book.save(out)
    return out.getvalue()


def test_of_a_workbook_nothing_changes_but_the_points() -> None:
    points = {"023100001": 90.0, "024100101": 95.5, "007": 60.0, "0007": 61.0, "241001234": 70.0, "lost": 1.0}

    filled = fill(own_sheet(), ["正方形"], points)

    before, after = (openpyxl.load_workbook(io.BytesIO(one)) for one in (own_sheet(), filled.content))
    assert after.sheetnames == before.sheetnames
    changed = {
        (sheet.title, cell.coordinate): after[sheet.title][cell.coordinate].value
        for sheet in before
        for row in sheet.iter_rows()
        for cell in row
        if after[sheet.title][cell.coordinate].value != cell.value
    }
    assert changed == {("平时成绩", "E3"): 90.0, ("平时成绩", "E4"): 95.5, ("平时成绩", "E7"): 70.0}
    sheet = after["平时成绩"]
    assert [str(one) for one in sheet.merged_cells.ranges] == ["A1:F1"]
    assert (sheet["A1"].font.b, sheet["A1"].font.sz, sheet.column_dimensions["C"].width) == (True, 16, 31.0)
    assert sheet["E3"].number_format == "General"  # as text it would be in no sum
    assert filled.filled == 3
    assert [(row.sheet, row.number, row.person) for row in filled.unknown] == [("平时成绩", 5, "s77")]
    assert [(row.number, row.person) for row in filled.ambiguous] == [(6, "7")]
    assert filled.missing == ("007", "0007", "lost")
    assert filled.blank == ()
    assert filled.formulas
    assert filled.lost == ()


def test_a_formula_in_the_way_is_kept() -> None:
    filled = fill(own_sheet(), ["总评"], {"024100101": 95.5})
    assert (filled.filled, [row.number for row in filled.kept]) == (0, [4])
    sheet = openpyxl.load_workbook(io.BytesIO(filled.content))["平时成绩"]
    assert sheet["F4"].value == "=D4+E4"


def test_two_rows_that_may_be_one_students_are_nobodys() -> None:
    content = csv([("学号", "成绩"), ("12", ""), ("0012", "")])
    filled = fill(content, ["成绩"], {"00012": 5.0})
    assert (filled.filled, [row.person for row in filled.ambiguous]) == (0, ["12", "0012"])


def test_what_a_workbook_would_lose_is_named() -> None:
    book = openpyxl.load_workbook(io.BytesIO(own_sheet()))
    out = io.BytesIO()
    book.save(out)
    with zipfile.ZipFile(out, "a") as archive:
        archive.writestr("xl/pivotTables/pivotTable1.xml", "<pivotTableDefinition/>")
    assert fill(out.getvalue(), ["正方形"], POINTS).lost == ("pivot_tables",)


def test_of_other_formats_only_contents_are_kept() -> None:
    content = (Path(__file__).parent / "files" / "roster.xls").read_bytes()
    assert fill(content, ["行政班"], POINTS).lost == ("formats",)


def test_the_first_name_that_the_sheet_has_is_filled_and_who_has_no_points_is_named() -> None:
    filled = fill(own_sheet(), ["Square", "正方形"], {"024100101": 95.5, "s77": None})
    assert (filled.column, filled.filled) == ("正方形", 1)
    assert [(row.sheet, row.number, row.person) for row in filled.blank] == [("平时成绩", 5, "s77")]
    with pytest.raises(NoColumnError) as missing:
        fill(own_sheet(), ["Square"], {})
    with pytest.raises(NoColumnError, match="choose the column and the file once more: 序号"):
        fill(own_sheet(), [""], {})
    assert missing.value.headings == ("序号", "姓名", "考勤", "正方形", "总评")
