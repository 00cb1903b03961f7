"""The process that reads one workbook: bytes on standard input, its sheets as JSON on standard output.

A workbook is a zip of XML, or a binary format of the nineties: much to go wrong for a file of somebody else's. So
it is read in a process of its own, with little memory and time. python-calamine also reads sheets whose declared
size is wrong, as some registries write them.
"""

import io
import json
import math
import sys
from datetime import date, time
from itertools import islice

from python_calamine import CalamineWorkbook, PasswordError, SheetTypeEnum, SheetVisibleEnum

from grader.formats.sheets.reading import DAMAGED, LARGE, LOCKED, MAX_CELLS, MAX_COLUMNS, MAX_ROWS
from grader.jail import readers

MAX_MEMORY_BYTES = 512 * 1024 * 1024
MAX_CPU_S = 10
MAX_CELL_CHARACTERS = 2_000
MAX_CHARACTERS = 4_000_000
"""Of all cells: a workbook of a few KiB can say one long text in each of a hundred thousand cells."""


def main() -> int:
    """Read; return 0 or the exit code that says why not."""
    readers.limit(MAX_MEMORY_BYTES, MAX_CPU_S)
    try:
        sheets = _sheets(CalamineWorkbook.from_filelike(io.BytesIO(sys.stdin.buffer.read())))
    except (_TooLargeError, MemoryError):
        return LARGE
    except PasswordError:
        return LOCKED
    except Exception:  # calamine's errors, and those of the libraries below it
        return DAMAGED
    sys.stdout.buffer.write(json.dumps(sheets, ensure_ascii=False).encode())
    return 0


class _TooLargeError(Exception):
    """The workbook has more rows, columns or cells than a class list or a gradebook needs."""


def _sheets(book: CalamineWorkbook) -> list[dict[str, object]]:
    sheets: list[dict[str, object]] = []
    room, text_room = MAX_CELLS, MAX_CHARACTERS
    for metadata in book.sheets_metadata:
        if metadata.typ is not SheetTypeEnum.WorkSheet:
            continue
        sheet = book.get_sheet_by_name(metadata.name)
        if sheet.total_height > MAX_ROWS or sheet.total_width > MAX_COLUMNS:
            raise _TooLargeError
        room -= sheet.height * sheet.width
        if room < 0:
            raise _TooLargeError
        first_row, first_column = sheet.start or (0, 0)
        margin: list[str | float] = [""] * first_column
        rows = []
        for row in islice(sheet.iter_rows(), first_row, None):  # it begins with the rows above
            cells = [_plain(cell) for cell in row]
            text_room -= sum(len(cell) for cell in cells if isinstance(cell, str))
            if text_room < 0:
                raise _TooLargeError
            rows.append(margin + cells)
        visible = metadata.visible is SheetVisibleEnum.Visible
        sheets.append({"name": metadata.name, "visible": visible, "first_row": first_row + 1, "rows": rows})
    return sheets


def _plain(cell: object) -> str | float:
    """Return a cell as text or as a number; a date as ISO 8601 writes it."""
    if isinstance(cell, bool):
        return str(cell).upper()  # as spreadsheets show it
    if isinstance(cell, (int, float)) and math.isfinite(cell):
        return cell
    text = cell.isoformat() if isinstance(cell, (date, time)) else str(cell)
    return text[:MAX_CELL_CHARACTERS]


if __name__ == "__main__":
    sys.exit(main())
