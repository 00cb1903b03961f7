"""Reading class lists: tables whose columns have the names that registries, platforms and teachers use."""

import csv
import io
import re
import unicodedata
from collections.abc import Sequence

from grader.contracts.errors import CourseError
from grader.contracts.identity import (
    Role,
    RosterEntry,
    checked_email,
    checked_id,
    checked_name,
    checked_section,
    difference,
    folded_id,
    is_person_id,
)
from grader.contracts.record import Record
from grader.contracts.text import Text
from grader.formats.sheets.reading import HEADER_ROWS, ListedRow, ListedTable, read_table

# Each column's names, the surest first: Canvas, for one, has its own number under "ID" beside the "SIS User ID".
_SUMS = ("合计", "总计", "小计", "共计", "人数", "总人数", "total", "sum")
_COLUMNS = {
    "id": (
        "学号", "学生学号", "学号/工号", "工号", "学籍号", "考号", "sis user id", "sid", "id number", "student id",
        "id", "student",
    ),
    "name": ("姓名", "学生姓名", "name", "full name", "student name", "student"),
    "first": ("first name", "名"),
    "last": ("last name", "姓"),
    "email": ("邮箱", "电子邮箱", "电子邮件", "email", "e-mail", "email address"),
    "sections": (
        "教学班", "教学班级", "教学班名称", "班级", "班级名称", "所在班级", "行政班", "行政班级", "班号", "用户组",
        "section", "sections",
    ),
    "role": ("角色", "role"),
}  # fmt: skip
_ROLES = {
    "学生": Role.STUDENT.value,
    "助教": Role.ASSISTANT.value,
    "教师": Role.INSTRUCTOR.value,
    "老师": Role.INSTRUCTOR.value,
    "ta": Role.ASSISTANT.value,
    "teaching assistant": Role.ASSISTANT.value,
    "teacher": Role.INSTRUCTOR.value,
}
_SHORTENED = re.compile(r"[0-9][.,]?[0-9]*e[+]?[0-9]+", re.IGNORECASE)
_WIDENING = re.compile(r"(?<=[^\x00-\x7f]) (?=[^\x00-\x7f])")
_SECTION_SEPARATOR = re.compile("[,;，；、]")
_NOBODY = frozenset({"points possible", "student, test", "test student"})
"""Names, in small letters, of rows without an id that Canvas exports beside the students."""


class SkippedRow(Record):
    """A row that names somebody who cannot be imported, and why."""

    number: int
    reason: Text


class Roster(Record):
    """The people in a class list, and the rows that cannot be imported.

    Attributes:
        encoding: of CSV; empty for a workbook.
    """

    entries: tuple[RosterEntry, ...]
    skipped: tuple[SkippedRow, ...]
    encoding: str

    def checked(self) -> tuple[RosterEntry, ...]:
        """Return the entries of a list without a wrong row.

        Raises:
            CourseError: rows were skipped; the message has a line for each.
        """
        if self.skipped:
            told = [
                Text(zh=f"第 {one.number} 行：{one.reason.zh}", en=f"line {one.number}: {one.reason.en}")
                for one in self.skipped
            ]
            raise CourseError(
                "\n".join(["nothing was imported:", *(one.en for one in told)]),
                "\n".join(["没有导入任何人：", *(one.zh for one in told)]),
            )
        return self.entries


def as_csv(entries: Sequence[RosterEntry]) -> str:
    """Return entries as `read_roster` reads them back."""
    out = io.StringIO()
    table = csv.writer(out, lineterminator="\n")
    table.writerow(("id", "name", "role", "email", "section"))
    for one in entries:
        table.writerow((one.id, one.name, one.role or "", one.email or "", "；".join(one.sections or ())))
    return out.getvalue()


def read_roster(content: bytes) -> Roster:
    """Return the people in a class list: a workbook or CSV, as `grader.formats.sheets.reading` reads them.

    The header stands in one of the first twelve rows and has a column of ids and one of names (or of first and
    last names); columns of e-mail addresses, sections and roles are read as well, others ignored. Titles,
    sub-headers and legends, which have neither an id nor a name, are passed over, and so is the same header again.

    Raises:
        CourseError: there is no table, no header, or nobody in it.
    """
    table = read_table(content, lambda cells: bool(_columns(cells)))
    start, columns = _header(table)
    entries: list[RosterEntry] = []
    skipped: list[SkippedRow] = []
    row_of: dict[str, tuple[int, str]] = {}
    width = len(table.rows[start - 1].cells)
    for row in table.rows[start:]:
        try:
            entry = _entry(row, columns)
            if entry is None:
                continue
            if any(row.cells[width:]):
                raise _shifted()
            _check_new(entry, row_of)
        except CourseError as error:
            skipped.append(SkippedRow(number=row.number, reason=error.text))
        else:
            row_of[folded_id(entry.id)] = row.number, entry.id
            entries.append(entry)
    skipped += _left_out(table, row_of)
    if not entries and not skipped:
        raise CourseError("the roster names nobody", "名单里没有人")
    return Roster(entries=tuple(entries), skipped=tuple(skipped), encoding=table.encoding)


def _left_out(table: ListedTable, row_of: dict[str, tuple[int, str]]) -> list[SkippedRow]:
    """Return the headers of other sheets that have people who are not on this one, such as one sheet a class."""
    found = []
    for other in table.others:
        start, columns = _found_header(other)
        cells = [row.cells[columns["id"] : columns["id"] + 1] for row in other.rows[start:]]
        ids = [unicodedata.normalize("NFKC", one).strip() for one, *_ in filter(None, cells)]
        missing = [one for one in ids if is_person_id(one) and folded_id(one) not in row_of]
        if missing:
            reason = Text(
                zh=f"工作表“{other.name}”里有 {len(missing)} 人不在“{table.name}”里（例如 {missing[0]}）："
                "请把所有人放进一个工作表",
                en=f"the sheet {other.name!r} has people who are not on {table.name!r}, such as {missing[0]} "
                f"({len(missing)} in all): put everybody on one sheet",
            )
            found.append(SkippedRow(number=other.rows[start - 1].number, reason=reason))
    return found


def _header(table: ListedTable) -> tuple[int, dict[str, int]]:
    """Return the index of the first row below the header, and where each column is."""
    start, columns = _found_header(table)
    if not columns:
        raise CourseError(
            "no column of ids beside one of names: one of the first rows must name the columns, such as "
            "id,name,role",
            "找不到列名：前几行里要有一行写着列名，至少有“学号”和“姓名”两列，例如 学号,姓名,角色",
        )
    _check_once(table.rows[start - 1], columns)
    return start, columns


def _found_header(table: ListedTable) -> tuple[int, dict[str, int]]:
    found = ((index, _columns(row.cells)) for index, row in enumerate(table.rows[:HEADER_ROWS], 1))
    return next(((start, columns) for start, columns in found if columns), (0, {}))


def _columns(cells: Sequence[str]) -> dict[str, int]:
    """Return the index of each column that a header has; nothing if ids or names are missing."""
    labels = [label(cell) for cell in cells]
    found: dict[str, int] = {}
    for column in _COLUMNS:
        index = _index_of(column, labels)
        if index is not None and index not in found.values():
            found[column] = index
    named = "name" in found or {"first", "last"} <= found.keys()
    return found if named and "id" in found else {}


def id_column(cells: Sequence[str]) -> int | None:
    """Return the index of the column of ids in a header, None if there is none."""
    return _index_of("id", [label(cell) for cell in cells])


def _index_of(column: str, labels: list[str]) -> int | None:
    return next((labels.index(one) for one in _COLUMNS[column] if one in labels), None)


def label(cell: str) -> str:
    """Return a column's name in a form in which equal names compare equal.

    Case, width, colons, the star of a required column and the spaces that widen a short name (姓　名) are dropped.
    """
    words = " ".join(unicodedata.normalize("NFKC", cell).casefold().strip(" *:").split())
    return words if words.isascii() else _WIDENING.sub("", words)


def _check_once(row: ListedRow, columns: dict[str, int]) -> None:
    labels = [label(cell) for cell in row.cells]
    for column, index in columns.items():
        if labels.count(labels[index]) > 1:
            raise CourseError(
                f"line {row.number}: two columns {labels[index]!r} ({column})",
                f"第 {row.number} 行：有两个“{row.cells[index]}”列",
            )


def _entry(row: ListedRow, columns: dict[str, int]) -> RosterEntry | None:
    """Return the person in a row, None if there is none."""
    cells = {column: row.cells[index] for column, index in columns.items() if index < len(row.cells)}
    person = unicodedata.normalize("NFKC", cells.get("id", "")).strip()
    name = cells.get("name") or _joined(cells.get("first", ""), cells.get("last", ""))
    if not person and (not name or name.casefold() in _NOBODY):  # two rows of Canvas
        return None
    if label(person) in _COLUMNS["id"] and label(name) in _COLUMNS["name"]:  # the header of the next page
        return None
    # else the sum is imported as a student's id; somebody with a name may really be called Sum
    if (not name or name.isdecimal()) and any(label(cell) in _SUMS for cell in row.cells):
        raise CourseError("this row adds up the others", "这一行是合计，不是学生")
    if not person:
        raise CourseError(f"no id beside the name {name[:40]}", f"“{name[:40]}”没有学号")
    email = cells.get("email", "")
    return RosterEntry(
        id=_checked_student(person),
        name=checked_name(name),
        role=_checked_role(cells.get("role", "")),
        email=checked_email(email) if email else None,
        sections=_checked_sections(cells.get("sections", "")),
    )


def _joined(first: str, last: str) -> str:
    """Return a full name: in Chinese, Japanese and Korean characters the last name comes first."""
    if any(unicodedata.east_asian_width(one) in "WF" for one in first + last):
        return f"{last}{first}"
    return f"{first} {last}".strip()


def _check_new(entry: RosterEntry, row_of: dict[str, tuple[int, str]]) -> None:
    number, before = row_of.get(folded_id(entry.id), (0, ""))
    if before == entry.id:
        raise CourseError(f"{entry.id} stands in line {number} already", f"第 {number} 行已经有 {entry.id}")
    if before:
        how = difference(entry.id, before)
        raise CourseError(
            f"{entry.id} differs from {before} in line {number} only in {how.en}",
            f"{entry.id} 和第 {number} 行的 {before} {how.zh}",
        )


def _shifted() -> CourseError:
    return CourseError(
        "more cells than columns: put quotes around a name with a comma",
        "单元格比列多：名字里有逗号时要加引号",
    )


def _checked_student(text: str) -> str:
    if _SHORTENED.fullmatch(text):
        raise CourseError(
            f"{text} is a number that a spreadsheet shortened: format the column as text, fill it in again",
            f"{text} 是被表格软件改成科学计数法的学号：把这一列设为“文本”，重新填写学号",
        )
    return checked_id(text, "id")


def _checked_role(text: str) -> Role | None:
    role = _ROLES.get(text.casefold(), text.casefold())
    if role and role not in list(Role):
        known = ", ".join(Role)
        raise CourseError(f"{text!r} is no role: use {known}", f"没有角色 {text!r}：只能用 学生、助教、教师")
    return Role(role) if role else None


def _checked_sections(text: str) -> tuple[str, ...] | None:
    """Return the sections that a cell names, None where it names none."""
    named = [checked_section(one) for one in _SECTION_SEPARATOR.split(text) if one.strip()]
    return tuple(dict.fromkeys(named)) or None
