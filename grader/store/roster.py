"""Reading a class list: CSV with a header line, columns ``id``, ``name`` and optionally ``role``."""

import csv
import io

from grader.contracts.errors import CourseError
from grader.contracts.identity import Role, RosterEntry, checked_id, checked_name

_REQUIRED = ("id", "name")
_KNOWN = (*_REQUIRED, "role")
MAX_ROSTER_BYTES = 4 * 1024 * 1024


def read_roster(content: bytes) -> tuple[RosterEntry, ...]:
    """Return the entries of a roster in order.

    Spreadsheet programs' byte order mark is fine; columns of other names are ignored.

    Raises:
        CourseError: the file is not right; the message has a line for each line of the file that is wrong.
    """
    if len(content) > MAX_ROSTER_BYTES:
        raise CourseError(f"the roster has more than {MAX_ROSTER_BYTES} bytes")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise CourseError(f"line {line}: not UTF-8: save the roster as CSV UTF-8") from None
    reader = csv.DictReader(io.StringIO(text, newline=""), strict=True)
    _check_header([name.strip().lower() for name in reader.fieldnames or ()])
    reader.fieldnames = [name.strip().lower() for name in reader.fieldnames or ()]
    return _entries(reader)


def _check_header(columns: list[str]) -> None:
    missing = [name for name in _REQUIRED if name not in columns]
    if missing:
        raise CourseError(f"line 1: no column {missing[0]!r}: the first line names the columns id,name,role")
    twice = [name for name in _KNOWN if columns.count(name) > 1]
    if twice:
        raise CourseError(f"line 1: two columns {twice[0]!r}")


def _entries(reader: "csv.DictReader[str]") -> tuple[RosterEntry, ...]:
    entries: list[RosterEntry] = []
    problems: list[str] = []
    first_line: dict[str, int] = {}
    try:
        for row in reader:
            line = reader.line_num
            try:
                entry = _entry(row)
                if entry.id in first_line:
                    raise CourseError(f"{entry.id} stands in line {first_line[entry.id]} already")
            except CourseError as error:
                problems.append(f"line {line}: {error}")
            else:
                first_line[entry.id] = line
                entries.append(entry)
    except csv.Error as error:
        problems.append(f"line {reader.line_num}: {error}")
    if problems:
        raise CourseError("\n".join(["nothing was imported:", *problems]))
    if not entries:
        raise CourseError("the roster names nobody")
    return tuple(entries)


def _entry(row: dict[str, str | None]) -> RosterEntry:
    role = (row.get("role") or "").strip().lower() or Role.STUDENT.value
    if role not in list(Role):
        raise CourseError(f"{role!r} is no role: use {', '.join(Role)}")
    return RosterEntry(
        id=checked_id((row["id"] or "").strip(), "id"), name=checked_name(row["name"] or ""), role=Role(role)
    )
