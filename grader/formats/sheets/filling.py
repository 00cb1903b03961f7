"""A teacher's own sheet with points filled in: the way into every platform that takes Excel files."""

import re
import unicodedata
from collections.abc import Mapping

from grader.contracts.errors import CourseError
from grader.contracts.record import Record
from grader.formats.sheets.reading import HEADER_ROWS, ListedTable, read_table
from grader.formats.sheets.roster import id_column, label
from grader.formats.sheets.writing import Cell, workbook

_NOT_IN_A_NAME = re.compile(r"[\[\]:*?/\\']")  # what Excel allows in no name of a sheet
_NUMBER = re.compile(r"-?(0|[1-9][0-9]{0,8})([.][0-9]+)?")


class FilledSheet(Record):
    """A file of sheets with points in them.

    Attributes:
        content: a workbook with the visible sheets that have ids; fonts, colours and widths are not kept.
        filled: how many rows got points. unknown: ids of rows that nobody in the course has.
    """

    content: bytes
    filled: int
    unknown: tuple[str, ...]


def fill(content: bytes, column: str, points: Mapping[str, float | None]) -> FilledSheet:
    """Return the sheets of a file with points in the column called `column`.

    The header of ids stands in one of the first rows, that of `column` in the same row or in a sub-header below.
    A row of somebody without points, and every other cell, stays as it is; so does a later sheet without `column`.

    Args:
        content: a workbook or CSV, as `grader.formats.sheets.reading` reads them.
        column: the header of the column to fill.
        points: by id of the student; None: nothing was handed in.

    Raises:
        CourseError: there is no table, or one of the two columns is missing in the first.
    """
    table = read_table(content, lambda cells: id_column(cells) is not None)
    known = {_folded(person): value for person, value in points.items()}
    sheets = [_filled(table, _columns(table, column), known)]
    for other in table.others:
        try:
            sheets.append(_filled(other, _columns(other, column), known))
        except CourseError:
            ids, header = _ids(other)
            sheets.append((_filled(other, (ids, ids, header + 1), {})[0], 0, []))
    names = _sheet_names([one.name for one in (table, *table.others)])
    return FilledSheet(
        content=workbook(list(zip(names, (cells for cells, _, _ in sheets), strict=True)), header=False),
        filled=sum(filled for _, filled, _ in sheets),
        unknown=tuple(one for _, _, unknown in sheets for one in unknown),
    )


def _filled(
    table: ListedTable, columns: tuple[int, int, int], known: Mapping[str, float | None]
) -> tuple[list[list[Cell]], int, list[str]]:
    """Return the cells of a sheet with points, how many rows got some, and the ids that nobody has."""
    ids, target, first = columns
    cells: list[list[Cell]] = [[] for _ in range(table.rows[-1].number)]
    filled, unknown = 0, []
    for index, row in enumerate(table.rows):
        cells[row.number - 1] = [
            _cell(cell, is_id=place == ids, is_header=index < first) for place, cell in enumerate(row.cells)
        ]
        person = row.cells[ids] if index >= first and ids < len(row.cells) else ""
        if not person:
            continue
        if _folded(person) not in known:
            unknown.append(person[:64])
            continue
        value = known[_folded(person)]
        if value is not None:
            line = cells[row.number - 1]
            line += [None] * (target + 1 - len(line))
            line[target] = value
            filled += 1
    return cells, filled, unknown


def _columns(table: ListedTable, wanted: str) -> tuple[int, int, int]:
    """Return the column of ids, the column to fill, and the index of the first row of a student."""
    ids, header = _ids(table)
    if ids < 0:
        raise CourseError(
            "no column of ids: one of the first rows must name it, such as id or 学号",
            "找不到学号列：前几行里要有一行写着列名，例如“学号”",
        )
    first = header + 1
    while first < len(table.rows) and not any(table.rows[first].cells[ids : ids + 1]):
        first += 1
    named: list[str] = []
    for row in table.rows[header:first]:
        labels = [label(cell) for cell in row.cells]
        if label(wanted) in labels:
            return ids, labels.index(label(wanted)), first
        named += [cell for cell in row.cells if cell]
    listed = ", ".join(dict.fromkeys(named))[:300]
    raise CourseError(
        f"no column {wanted[:60]!r}; there are: {listed}", f"没有“{wanted[:60]}”这一列；表里有：{listed}"
    )


def _ids(table: ListedTable) -> tuple[int, int]:
    """Return the column of ids and the index of the row that names it; -1 and 0 where there is none."""
    found = ((id_column(row.cells), index) for index, row in enumerate(table.rows[:HEADER_ROWS]))
    return next(((ids, index) for ids, index in found if ids is not None), (-1, 0))


def _sheet_names(given: list[str]) -> list[str]:
    """Return names that Excel takes, of which no two are the same."""
    names = [_NOT_IN_A_NAME.sub(" ", one)[:31].strip() or "成绩" for one in given]
    unique = len({one.casefold() for one in names}) == len(names)
    return names if unique else [f"{number} {one}"[:31] for number, one in enumerate(names, 1)]


def _folded(person: str) -> str:
    return unicodedata.normalize("NFKC", person).strip().casefold()


def _cell(text: str, *, is_id: bool, is_header: bool) -> Cell:
    """Return a cell as it was read, text that is a number as a number; ids and headers stay text."""
    if not text:
        return None
    return float(text) if not is_id and not is_header and _NUMBER.fullmatch(text) else text
