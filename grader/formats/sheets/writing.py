"""Tables that go out: CSV and workbooks, of which no cell is ever taken for a formula."""

import csv
import io
from collections.abc import Sequence
from datetime import datetime

from grader.contracts.python import UTC
from grader.contracts.text import BYTE_ORDER_MARK

Cell = str | float | None
"""Text, a number, or nothing."""

MEDIA_TYPE = "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet"
"""Of a workbook."""

_FORMULA = ("=", "+", "-", "@", "＝", "＋", "－", "＠", "\t", "\r", "\n")
_NO_TIME = datetime(2000, 1, 1, tzinfo=UTC).replace(tzinfo=None)  # so that the same cells give the same bytes


def as_text(value: str) -> str:
    """Return a cell of CSV that a spreadsheet program takes for text.

    An apostrophe stands before what it would take for a formula (OWASP, "CSV Injection"); with an East Asian
    locale that includes the full-width signs.
    """
    return "'" + value if value.startswith(_FORMULA) else value


def csv_table(rows: Sequence[Sequence[str]], *, safe: bool = True) -> str:
    """Return rows as CSV for spreadsheet programs.

    `safe`: pass every cell through `as_text`; otherwise whoever made them has.
    """
    out = io.StringIO()
    shown = [[as_text(cell) for cell in row] for row in rows] if safe else rows
    csv.writer(out, lineterminator="\r\n").writerows(shown)
    return BYTE_ORDER_MARK + out.getvalue()


def workbook(sheets: Sequence[tuple[str, Sequence[Sequence[Cell]]]], *, header: bool = True) -> bytes:
    """Return a workbook.

    Args:
        sheets: name and rows of each. Text is text, whatever it looks like, so that ids keep their zeros.
        header: the first row of each sheet names the columns.
    """
    import xlsxwriter  # no service that starts has to wait for it

    out = io.BytesIO()
    with xlsxwriter.Workbook(out, {"in_memory": True}) as book:
        book.set_properties({"created": _NO_TIME})
        bold, text = book.add_format({"bold": True}), book.add_format({"num_format": "@"})
        for name, rows in sheets:
            sheet = book.add_worksheet(name)
            if header:
                sheet.freeze_panes(1, 0)
            for number, row in enumerate(rows):
                for column, cell in enumerate(row):
                    if isinstance(cell, str):
                        sheet.write_string(number, column, cell, bold if header and number == 0 else text)
                    elif cell is not None:
                        sheet.write_number(number, column, cell)
    return out.getvalue()
