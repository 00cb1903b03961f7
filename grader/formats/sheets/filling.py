"""A teacher's own sheet with points filled in: the way into every platform that takes Excel files."""

import io
import json
import re
import sys
import unicodedata
import zipfile
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Final

from grader.contracts.errors import CourseError
from grader.contracts.python import SAFE_PATH
from grader.contracts.record import Record, from_json
from grader.formats.sheets.reading import HEADER_ROWS, LARGE, ListedTable, read_table, refused
from grader.formats.sheets.roster import id_column, label
from grader.formats.sheets.writing import Cell, workbook
from grader.jail import readers

_NOT_IN_A_NAME = re.compile(r"[\[\]:*?/\\']")  # what Excel allows in no name of a sheet
_NUMBER = re.compile(r"-?(0|[1-9][0-9]{0,8})([.][0-9]+)?")
_ROUNDED = re.compile(r"[0-9](?:[.]([0-9]+))?e[+]?[0-9]+")
"""What spreadsheets make of a long number in a narrow column."""

_MAX_PATCHED_BYTES: Final = 16 * 1024 * 1024


class SheetRow(Record):
    """A row of a student. `sheet` is empty for CSV; `number` as the file's own program counts it, from 1."""

    sheet: str
    number: int
    person: str


class NoColumnError(CourseError):
    """A sheet has none of the columns that may be filled. `headings`: those that it has."""

    def __init__(self, wanted: str, headings: Sequence[str]) -> None:
        listed = ", ".join(headings)[:300]
        en, zh = f"no column {wanted[:60]!r}; there are:", f"没有“{wanted[:60]}”这一列；表里有："
        if not wanted:
            en, zh = "choose the column and the file once more:", "请选好要填的列，再选一次文件："
        super().__init__(f"{en} {listed}", f"{zh}{listed}")
        self.headings = tuple(headings)


class FilledSheet(Record):
    """A file of sheets with points in them.

    Attributes:
        content: a workbook. Of one in .xlsx everything else is as it was, but for what `lost` names.
        column: the header of the column that was filled.
        filled: how many rows got points.
        unknown: rows with an id that nobody in the course has.
        ambiguous: rows with an id that lost zeros or digits and may be several students'.
        blank: rows of students who have no points; they were left alone.
        kept: rows whose cell holds a formula or is merged with another; it was left alone.
        missing: ids of students with points whom no row names.
        formulas: whether there are formulas, whose values a spreadsheet program computes when it opens the file.
        lost: kinds of things that the new file lacks (`grader.formats.sheets.patching`); ``formats``: formulas,
            fonts, colours, widths and sheets without ids.
    """

    content: bytes
    column: str
    filled: int
    unknown: tuple[SheetRow, ...] = ()
    ambiguous: tuple[SheetRow, ...] = ()
    blank: tuple[SheetRow, ...] = ()
    kept: tuple[SheetRow, ...] = ()
    missing: tuple[str, ...] = ()
    formulas: bool = False
    lost: tuple[str, ...] = ()


class _Patched(Record):
    kept: list[tuple[str, int]]
    formulas: bool
    lost: list[str]


class _Target(Record):
    """A sheet to fill: indices of the column of ids, of the column to fill, and of the first student's row."""

    table: ListedTable
    ids: int
    column: int
    header: str
    first: int


class _Place(Record):
    """Where a student's points go. `exact`: the row has the very id."""

    row: SheetRow
    column: int
    student: str
    exact: bool


def fill(content: bytes, columns: Sequence[str], points: Mapping[str, float | None]) -> FilledSheet:
    """Return the sheets of a file with points in a column.

    The header of ids stands in one of the first rows, that of the column in the same row or in a sub-header below.
    A row of somebody without points stays as it is; so does a later sheet without the column. An id that lost
    leading zeros, or became a rounded number, counts as the one student's whom it fits.

    Args:
        content: a workbook or CSV, as `grader.formats.sheets.reading` reads them.
        columns: headers; the column with the first of them that the first sheet has is filled.
        points: by id of the student; None: nothing was handed in.

    Raises CourseError: there is no table, or one of the two columns is missing in the first (`NoColumnError`).
    """
    table = read_table(content, lambda cells: id_column(cells) is not None)
    targets = [_target(table, columns)]
    for other in table.others:
        with suppress(CourseError):
            targets.append(_target(other, [targets[0].header]))
    students = _Students(points)
    places: list[_Place] = []
    unknown: list[SheetRow] = []
    ambiguous: list[SheetRow] = []
    for target in targets:
        _match(target, students, places, unknown, ambiguous)
    named = {place.student for place in places}
    blank = [place.row for place in places if points[place.student] is None]
    places = [place for place in places if points[place.student] is not None]
    filled = FilledSheet(
        content=b"",
        column=targets[0].header,
        filled=len(places),
        unknown=tuple(unknown),
        ambiguous=tuple(ambiguous),
        blank=tuple(blank),
        missing=tuple(one for one, value in points.items() if value is not None and one not in named),
    )
    if _is_xlsx(content):
        return _patched(content, places, points, filled)
    return _made_anew(table, places, points, filled)


class _Students:
    """Finds whom an id in a sheet means."""

    def __init__(self, points: Mapping[str, float | None]) -> None:
        self._exact = {_folded(person): person for person in points}
        self._numbers = [(id_, int(id_)) for id_ in self._exact if id_.isdecimal()]

    def meant_by(self, written: str) -> tuple[list[str], bool]:
        """Return everybody whom an id may mean, and whether it is somebody's very id."""
        folded = _folded(written)
        if folded in self._exact:
            return [self._exact[folded]], True
        if folded.isdecimal():
            bare = int(folded)
            fitting = [id_ for id_, number in self._numbers if number == bare]
        elif rounded := _ROUNDED.fullmatch(folded):
            digits, value = len(rounded[1] or ""), float(folded)
            fitting = [id_ for id_, number in self._numbers if float(f"{number:.{digits}e}") == value]
        else:
            fitting = []
        return [self._exact[id_] for id_ in fitting], False


def _match(
    target: _Target,
    students: _Students,
    places: list[_Place],
    unknown: list[SheetRow],
    ambiguous: list[SheetRow],
) -> None:
    """Add each row of a sheet to the list that it belongs to."""
    places_here: list[_Place] = []
    for line in target.table.rows[target.first :]:
        if not (written := "".join(line.cells[target.ids : target.ids + 1])):
            continue
        row = SheetRow(sheet=target.table.name, number=line.number, person=written[:64])
        meant, exact = students.meant_by(written)
        if len(meant) == 1:
            places_here.append(_Place(row=row, column=target.column, student=meant[0], exact=exact))
        else:
            (ambiguous if meant else unknown).append(row)
    exactly = {place.student for place in places_here if place.exact}
    times = Counter(place.student for place in places_here if not place.exact)
    for place in places_here:
        if place.exact or (times[place.student] == 1 and place.student not in exactly):
            places.append(place)
        else:  # two rows may be this student's
            ambiguous.append(place.row)


def _is_xlsx(content: bytes) -> bool:
    if not zipfile.is_zipfile(io.BytesIO(content)):
        return False
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        return "xl/workbook.xml" in archive.namelist()


def _patched(
    content: bytes, places: Sequence[_Place], points: Mapping[str, float | None], filled: FilledSheet
) -> FilledSheet:
    """Have points written into the file itself, by a process of its own."""
    cells: dict[str, list[tuple[int, int, float | None]]] = {}
    for place in places:
        cells.setdefault(place.row.sheet, []).append(
            (place.row.number, place.column + 1, points[place.student])
        )
    command = [sys.executable, *SAFE_PATH, "-m", "grader.formats.sheets.patching"]
    asked = json.dumps(cells).encode() + b"\n" + content
    try:
        code, answer = readers.answer_of(command, asked, most_bytes=_MAX_PATCHED_BYTES)
    except readers.TooMuchError:
        raise refused(LARGE) from None
    if code:
        raise refused(code)
    told, _, patched_file = answer.partition(b"\n")
    done = from_json(_Patched, told)
    kept = [place.row for place in places if (place.row.sheet, place.row.number) in {*done.kept}]
    return replace(
        filled,
        content=patched_file,
        filled=filled.filled - len(kept),
        kept=tuple(kept),
        formulas=done.formulas,
        lost=tuple(done.lost),
    )


def _made_anew(
    table: ListedTable, places: Sequence[_Place], points: Mapping[str, float | None], filled: FilledSheet
) -> FilledSheet:
    """Return the cells in a new workbook: formats other than .xlsx cannot be written into."""
    values = {(place.row.sheet, place.row.number): (place.column, points[place.student]) for place in places}
    tables = (table, *table.others)
    sheets = [_cells(one, values) for one in tables]
    names = _sheet_names([one.name for one in tables])
    return replace(
        filled,
        content=workbook(list(zip(names, sheets, strict=True)), header=False),
        lost=() if table.encoding else ("formats",),
    )


def _cells(
    table: ListedTable, values: Mapping[tuple[str, int], tuple[int, float | None]]
) -> list[list[Cell]]:
    ids, header = _ids(table)
    cells: list[list[Cell]] = [[] for _ in range(table.rows[-1].number)]
    for index, row in enumerate(table.rows):
        line = cells[row.number - 1] = [
            _cell(cell, is_id=place == ids, is_header=index <= header) for place, cell in enumerate(row.cells)
        ]
        if (table.name, row.number) in values:
            column, value = values[table.name, row.number]
            line += [None] * (column + 1 - len(line))
            line[column] = value
    return cells


def _target(table: ListedTable, wanted: Sequence[str]) -> _Target:
    """Return where to fill a sheet. Raises CourseError: one of the two columns is missing."""
    ids, header = _ids(table)
    if ids < 0:
        raise CourseError(
            "no column of ids: one of the first rows must name it, such as id or 学号",
            "找不到学号列：前几行里要有一行写着列名，例如“学号”",
        )
    first = header + 1
    while first < len(table.rows) and not any(table.rows[first].cells[ids : ids + 1]):
        first += 1
    headers = [
        (cell, place)
        for row in table.rows[header:first]
        for place, cell in enumerate(row.cells)
        if cell and place != ids
    ]
    for one in wanted:
        for cell, place in headers:
            if label(cell) == label(one):
                return _Target(table=table, ids=ids, column=place, header=cell, first=first)
    raise NoColumnError(wanted[0], list(dict.fromkeys(cell for cell, _ in headers)))


def _ids(table: ListedTable) -> tuple[int, int]:
    """Return the column of ids and the index of the row that names it; -1 and 0 where there is none."""
    columns = ((id_column(row.cells), index) for index, row in enumerate(table.rows[:HEADER_ROWS]))
    return next(((ids, index) for ids, index in columns if ids is not None), (-1, 0))


def _sheet_names(given: list[str]) -> list[str]:
    """Return names that Excel takes, of which no two are the same."""
    names = [_NOT_IN_A_NAME.sub(" ", name)[:31].strip() or "成绩" for name in given]
    unique = len({name.casefold() for name in names}) == len(names)
    return names if unique else [f"{number} {one}"[:31] for number, one in enumerate(names, 1)]


def _folded(person: str) -> str:
    return unicodedata.normalize("NFKC", person).strip().casefold()


def _cell(text: str, *, is_id: bool, is_header: bool) -> Cell:
    """Return a cell as it was read, text that is a number as a number; ids and headers stay text."""
    if not text:
        return None
    return float(text) if not is_id and not is_header and _NUMBER.fullmatch(text) else text
