"""Points filled into sheets as registries and platforms hand them out; all names are invented."""

import io
from pathlib import Path

import pytest
from python_calamine import CalamineWorkbook

from grader.contracts.errors import CourseError
from grader.formats.sheets.filling import FilledSheet, fill
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
    filled = fill(with_wrong_dimension(workbook(REGISTRY)), "作业", POINTS)
    assert (filled.filled, filled.unknown) == (1, ())
    after = rows(filled)
    assert after[6][5] == 87.5
    after[6][5] = ""
    assert [[str(cell).removesuffix(".0") for cell in row] for row in after] == [
        [str(cell).removesuffix(".0") for cell in row] for row in before
    ]


def test_ids_match_however_they_are_written() -> None:
    content = csv([("学号", "成绩"), ("２５３０１２３４５６", ""), ("2530123457.0", "5"), ("99", "7")])
    filled = fill(content, " 成绩：", POINTS)
    assert [row[1] for row in rows(filled)] == ["成绩", 87.5, 5.0, 7.0]
    assert (filled.filled, filled.unknown) == (1, ("99",))


def test_old_workbooks_come_back_as_new_ones() -> None:
    content = (Path(__file__).parent / "files" / "roster.xls").read_bytes()
    assert rows(fill(content, "行政班", POINTS))[2][3] == 87.5


def test_ids_keep_their_zeros_and_text_is_never_a_formula() -> None:
    content = csv([("学号", "备注", "成绩"), ("007", "=1+1", "")])
    assert rows(fill(content, "成绩", {"007": 1.0}))[1] == ["007", "=1+1", 1.0]


def test_a_line_break_in_a_cell_begins_no_row() -> None:
    content = csv([("学号", "备注", "成绩"), ("1", '"a\nb"', ""), ("2", "", "")])
    filled = rows(fill(content, "成绩", {"1": 1.0, "2": 2.0}))
    assert [row[2] for row in filled] == ["成绩", 1.0, 2.0]


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (csv(PAPER), r"no column '总评'; there are: 学号, 姓名, 进入考试时间"),
        (csv([("姓名", "成绩"), ("李", "")]), "no column of ids"),
        (b"", "no column of ids"),
    ],
)
def test_what_cannot_be_filled_says_what_is_there(content: bytes, why: str) -> None:
    with pytest.raises(CourseError, match=why):
        fill(content, "总评", POINTS)


def test_every_sheet_is_filled_and_those_without_the_column_stay() -> None:
    """Teachers have one sheet for each class."""
    sheets = (
        [("学号", "姓名", "成绩"), (*LI, "")],
        [("说明",), ("没有学号",)],
        [("学号", "成绩"), ("x", ""), ("y", 5)],
        [("学号", "备注"), ("x", 7)],
    )
    filled = fill(workbook(*sheets), "成绩", POINTS)
    book = CalamineWorkbook.from_filelike(io.BytesIO(filled.content))
    assert [book.get_sheet_by_index(number).to_python() for number in range(len(book.sheet_names))] == [
        [["学号", "姓名", "成绩"], [*LI, 87.5]],
        [["学号", "成绩"], ["x", 1.0], ["y", 5.0]],
        [["学号", "备注"], ["x", 7.0]],
    ]
    assert (filled.filled, filled.unknown) == (2, ("y",))
