"""The process that writes points into one workbook: numbers into cells, everything else of the file as it was.

Standard input is a line of JSON, the cells by sheet as `grader.formats.sheets.filling` sends them, and the file.
Standard output is a line of JSON, a `Patched`, and the new file. openpyxl keeps formulas, styles, widths, merged
cells and other sheets, but not everything that a workbook can hold: what the new file lacks is named.
"""

import io
import json
import re
import sys
import zipfile
from typing import Final

from openpyxl import load_workbook
from openpyxl.cell.cell import MergedCell
from openpyxl.workbook import Workbook

from grader.formats.sheets.reading import DAMAGED, LARGE
from grader.formats.sheets.workbook import MAX_CPU_S, MAX_MEMORY_BYTES
from grader.jail import readers

LOSSES: Final = {
    "charts": "xl/charts/",
    "pictures": "xl/media/",
    "pivot_tables": "xl/pivotTables/",
    "macros": "xl/vbaProject",
    "comments": "xl/threadedComments/",
    "controls": "xl/ctrlProps/",
}
"""What openpyxl may leave out, by how the names of its parts begin."""

_EXTENSIONS: Final = re.compile(rb"<(?:\w+:)?extLst\b")
"""Newer conditional formats, drop-down lists and sparklines stand there; openpyxl leaves them out."""


def main() -> int:
    """Write; return 0 or the exit code that says why not."""
    readers.limit(2 * MAX_MEMORY_BYTES, 2 * MAX_CPU_S)
    asked, _, content = sys.stdin.buffer.read().partition(b"\n")
    try:
        book = load_workbook(io.BytesIO(content), keep_vba=_has(content, "xl/vbaProject"), rich_text=True)
        kept, formulas = _write(book, json.loads(asked))
        out = io.BytesIO()
        book.save(out)
    except MemoryError:
        return LARGE
    except Exception:  # openpyxl's errors, and those of the libraries below it
        return DAMAGED
    outcome = {"kept": kept, "formulas": formulas, "lost": _lost(content, out.getvalue())}
    sys.stdout.buffer.write(json.dumps(outcome).encode() + b"\n" + out.getvalue())
    return 0


def _write(
    book: Workbook, asked: dict[str, list[tuple[int, int, float]]]
) -> tuple[list[tuple[str, int]], bool]:
    """Write numbers into cells; return which rows kept what they had, and whether there are formulas."""
    kept = []
    for name, cells in asked.items():
        sheet = book[name]
        for row, column, value in cells:
            cell = sheet.cell(row, column)
            if isinstance(cell, MergedCell) or cell.data_type == "f":
                kept.append((name, row))
            else:
                cell.value = value
                if cell.number_format == "@":  # a number in a cell of text would be left out of every sum
                    cell.number_format = "General"
    formulas = any(
        cell.data_type == "f" for sheet in book.worksheets for row in sheet.iter_rows() for cell in row
    )
    return kept, formulas


def _has(content: bytes, prefix: str) -> bool:
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        return any(name.startswith(prefix) for name in archive.namelist())


def _lost(before: bytes, after: bytes) -> list[str]:
    """Return the kinds of things of which the new file has fewer."""
    with zipfile.ZipFile(io.BytesIO(before)) as old, zipfile.ZipFile(io.BytesIO(after)) as new:
        parts = [archive.namelist() for archive in (old, new)]
        lost = [
            kind
            for kind, prefix in LOSSES.items()
            if sum(name.startswith(prefix) for name in parts[0])
            > sum(name.startswith(prefix) for name in parts[1])
        ]
        sheets = [name for name in parts[0] if name.startswith("xl/worksheets/sheet")]
        return lost + ["extensions"] * any(_EXTENSIONS.search(old.read(name)) for name in sheets)


if __name__ == "__main__":
    sys.exit(main())
