"""Reading tables of other programs as rows of text: workbooks (.xlsx, .xls, .ods), CSV as spreadsheets save it."""

import codecs
import csv
import io
import re
import sys
import unicodedata
import zipfile
from collections.abc import Callable, Iterator, Sequence
from itertools import islice

from grader.contracts.errors import CourseError
from grader.contracts.python import SAFE_PATH
from grader.contracts.record import Record, from_json
from grader.jail import readers

MAX_FILE_BYTES = 4 * 1024 * 1024
HEADER_ROWS = 12
"""Titles stand above the header; registries put up to four rows there."""

MAX_ROWS = 20_000
MAX_COLUMNS = 300
MAX_CELLS = 400_000
"""Of a table, whatever file it comes in: more than any class list or gradebook needs."""

DAMAGED, LOCKED, LARGE = 3, 4, 5
"""Exit codes of the reader of workbooks: nobody can read it, it has a password, it is too large."""

_MAX_UNPACKED_BYTES = 64 * 1024 * 1024
_MAX_MEMBERS = 200
_MAX_ANSWER_BYTES = 64 * 1024 * 1024
_ZIP, _OLE = b"PK\x03\x04", b"\xd0\xcf\x11\xe0"
_MARKUP, _PDF = b"<", b"%PDF"
"""What registries call .xls, too: a web page, or Excel's XML of 2003. Spreadsheets save either as .xlsx."""

_SEPARATORS = (",", "\t", ";", "，")
_EXACT_BELOW = 10**15  # a spreadsheet keeps 15 digits of a number
_FLOATED = re.compile(r"([0-9]{4,15})\.0")
_KEPT_AS_TEXT = re.compile(r'="([^"]*)"')  # a formula, by which programs save leading zeros from Excel


class ListedRow(Record):
    """One row of a table. `number` as the file's own program counts it, from 1."""

    number: int
    cells: tuple[str, ...]


class ListedTable(Record):
    """A table, and what is worth telling of how it was read.

    Attributes:
        name: of the sheet; empty for CSV.
        encoding: of CSV; empty for a workbook.
        others: the workbook's other visible sheets with a header.
    """

    name: str
    encoding: str
    rows: tuple[ListedRow, ...]
    others: tuple["ListedTable", ...] = ()


class _Sheet(Record):
    name: str
    visible: bool
    first_row: int
    rows: list[list[str | float]]


def read_table(content: bytes, is_header: Callable[[Sequence[str]], bool]) -> ListedTable:
    """Return the table of a file: of a workbook, the first sheet one of whose first rows is a header.

    If none is, the first table is returned, and the caller says what is missing. Hidden sheets are passed over.
    Rows without any text are left out. CSV may be separated by commas (also full-width ones), semicolons or tabs,
    in UTF-8, UTF-16 or GBK. Cells have no space around them.

    `is_header` says whether a row names the columns that are needed.

    Raises:
        CourseError: no table can be read.
        InfrastructureError: the host had no time or memory for reading it.
    """
    if len(content) > MAX_FILE_BYTES:
        raise CourseError(
            f"the file has more than {MAX_FILE_BYTES // 1024**2} MiB",
            f"文件超过 {MAX_FILE_BYTES // 1024**2} MiB",
        )
    if content.removeprefix(codecs.BOM_UTF8).lstrip().startswith((_MARKUP, _PDF)):
        raise refused(DAMAGED)
    if content.startswith((_ZIP, _OLE)):
        tables: Iterator[ListedTable] = (_of_sheet(sheet) for sheet in _workbook(content) if sheet.visible)
    else:
        tables = _of_csv(content)
    first: ListedTable | None = None
    for table in tables:
        first = first or table
        if _has_header(table, is_header):
            others = () if table.encoding else tuple(one for one in tables if _has_header(one, is_header))
            return ListedTable(name=table.name, encoding=table.encoding, rows=table.rows, others=others)
    if first is None:
        raise CourseError("the file has no table", "文件里没有表格")
    return first


def _has_header(table: ListedTable, is_header: Callable[[Sequence[str]], bool]) -> bool:
    return any(is_header(row.cells) for row in table.rows[:HEADER_ROWS])


def _of_sheet(sheet: _Sheet) -> ListedTable:
    rows = (
        ListedRow(number=number, cells=tuple(map(_text, cells)))
        for number, cells in enumerate(sheet.rows, sheet.first_row)
    )
    return ListedTable(name=sheet.name, encoding="", rows=tuple(row for row in rows if any(row.cells)))


def _text(cell: str | float) -> str:
    """Return a cell as a spreadsheet shows it: of 16 digits or more it has lost the last, so they are left out."""
    if isinstance(cell, str):
        return _visible(cell).removeprefix("'")
    if cell == int(cell) and abs(cell) < _EXACT_BELOW:
        return str(int(cell))
    return f"{cell:.5E}" if abs(cell) >= _EXACT_BELOW else str(cell)


def _visible(cell: str) -> str:
    """Return a cell without what web pages leave in text that is copied from them, such as zero-width spaces."""
    return "".join(character for character in cell if unicodedata.category(character) != "Cf").strip()


def _workbook(content: bytes) -> list[_Sheet]:
    """Return all sheets of a workbook, read by a process of its own."""
    if content.startswith(_ZIP):
        _check_zip(content)
    command = [sys.executable, *SAFE_PATH, "-m", "grader.formats.sheets.workbook"]
    try:
        code, answer = readers.answer_of(command, content, most_bytes=_MAX_ANSWER_BYTES)
    except readers.TooMuchError:
        raise refused(LARGE) from None
    if code:
        raise refused(code)
    return from_json(list[_Sheet], answer)


def _check_zip(content: bytes) -> None:
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            members = archive.infolist()
    except (zipfile.BadZipFile, ValueError, NotImplementedError):
        raise refused(DAMAGED) from None
    if len(members) > _MAX_MEMBERS or sum(member.file_size for member in members) > _MAX_UNPACKED_BYTES:
        raise refused(LARGE)


def refused(code: int) -> CourseError:
    """Return what a process that read a workbook says by its exit code."""
    if code == DAMAGED:
        return CourseError(
            "the file is damaged or no workbook: open it in a spreadsheet program and save it as .xlsx",
            "文件损坏或不是表格文件：请用 Excel 或 WPS 打开，另存为 .xlsx",
        )
    if code == LOCKED:
        return CourseError(
            "the workbook has a password: save it without one", "表格文件设了密码：请去掉密码后再保存"
        )
    return CourseError(
        f"the table is too large ({MAX_ROWS} rows, {MAX_COLUMNS} columns): copy the class list into a new one",
        f"表格太大（最多 {MAX_ROWS} 行、{MAX_COLUMNS} 列）：请把名单复制到一个新的文件里",
    )


def _of_csv(content: bytes) -> Iterator[ListedTable]:
    """Yield the file as read with each separator that its first lines have; only the last may be broken."""
    encoding, text = _decoded(content)
    head = "".join(islice(io.StringIO(text), HEADER_ROWS))
    present = [one for one in _SEPARATORS if one in head] or [","]
    for separator in present:
        try:
            rows = _csv_rows(text, separator)
        except CourseError:
            if separator == present[-1]:
                raise
        else:
            yield ListedTable(name="", encoding=encoding, rows=rows)


def _csv_rows(text: str, separator: str) -> tuple[ListedRow, ...]:
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator, strict=True)
    rows = []
    line, room = 1, MAX_CELLS
    try:
        for number, cells in enumerate(reader, 1):
            room -= len(cells)
            if number > MAX_ROWS or len(cells) > MAX_COLUMNS or room < 0:
                raise refused(LARGE)
            row = ListedRow(number=number, cells=tuple(map(_csv_text, cells)))
            if any(row.cells):
                rows.append(row)
            line = reader.line_num + 1
    except csv.Error:  # a quotation mark that is not closed is noticed at the end of the file
        raise CourseError(
            f"line {line}: its quotation marks do not match: remove them, or save the table as CSV once more",
            f"第 {line} 行：引号不成对：删掉多余的引号，或者用 Excel、WPS 重新另存为 CSV",
        ) from None
    return tuple(rows)


def _csv_text(cell: str) -> str:
    text = _visible(cell).removeprefix("'")
    if kept := _KEPT_AS_TEXT.fullmatch(text):
        return kept[1].strip()
    floated = _FLOATED.fullmatch(text)  # a whole number, written by a program that keeps it as a float
    return floated[1] if floated else text


def _decoded(content: bytes) -> tuple[str, str]:
    """Return the encoding and the text of CSV."""
    for encoding in _encodings(content):
        try:
            return encoding, content.decode(encoding).removeprefix("\ufeff")
        except UnicodeDecodeError as error:
            wrong = error
    line = content.count(b"\n", 0, wrong.start) + 1
    raise CourseError(
        f"line {line}: neither UTF-8, UTF-16 nor GBK: save the file as CSV UTF-8",
        f"第 {line} 行：不是 UTF-8、UTF-16 或 GBK 编码：请把文件另存为“CSV UTF-8”",
    )


def _encodings(content: bytes) -> tuple[str, ...]:
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        return ("utf-16",)
    if b"\0" in content:  # half of each digit, comma and line end
        first_halves, second_halves = content[::2].count(0), content[1::2].count(0)
        return ("utf-16-be",) if first_halves > second_halves else ("utf-16-le",)
    return ("utf-8", "gb18030")
