"""Reading class lists: tables whose columns have the names that registries, platforms and teachers use."""

import csv
import io
import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import replace

from grader.contracts.errors import CourseError
from grader.contracts.identity import (
    Role,
    RosterEntry,
    checked_email,
    checked_id,
    checked_section,
    difference,
    folded_id,
    is_person_id,
    person_name,
)
from grader.contracts.record import Record
from grader.contracts.text import Text
from grader.formats.sheets.reading import HEADER_ROWS, ListedRow, ListedTable, read_table

# Each column's names, the surest first: Canvas, for one, has its own number under "ID" beside the "SIS User ID".
_SUMS = ("合计", "总计", "小计", "共计", "人数", "总人数", "total", "sum")
_SUM_FOR_AN_ID = re.compile("(合计|总计|小计|共计|总?人数).*")  # no id: ids are of ASCII characters
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
_UNNAMED_SHEET = re.compile(r"(sheet|工作表|表)\s*[0-9]*")
_SECTION_SEPARATOR = re.compile("[,;，；、]")
_NOBODY = frozenset({"points possible", "student, test", "test student"})
"""Names, in small letters, of rows without an id that Canvas exports beside the students."""


class RowPlace(Record):
    """Where a row stands: `sheet` is empty where only one table was read, `number` counts from 1."""

    sheet: str
    number: int

    @property
    def words(self) -> Text:
        """How a sentence names the row."""
        if not self.sheet:
            return Text(zh=f"第 {self.number} 行", en=f"line {self.number}")
        return Text(
            zh=f"工作表“{self.sheet}”第 {self.number} 行", en=f"sheet {self.sheet!r}, line {self.number}"
        )


class SkippedRow(Record):
    """A row that names somebody who cannot be imported, and why."""

    place: RowPlace
    reason: Text


class RestoredRow(Record):
    """A row whose id had lost zeros at its beginning: as it stands there, and whom it means."""

    place: RowPlace
    written: str
    id: str


class Roster(Record):
    """The people in a class list, and the rows that cannot be imported.

    Attributes:
        places: where each of the people stands, by id.
        encoding: of CSV; empty for a workbook.
        restored: rows whose ids got their zeros back.
    """

    entries: tuple[RosterEntry, ...]
    places: dict[str, RowPlace]
    skipped: tuple[SkippedRow, ...]
    encoding: str
    restored: tuple[RestoredRow, ...] = ()

    def checked(self) -> tuple[RosterEntry, ...]:
        """Return the entries of a list without a wrong row.

        Raises CourseError: rows were skipped; the message has a line for each.
        """
        if self.skipped:
            rows = [(row.place.words, row.reason) for row in self.skipped]
            raise CourseError(
                "\n".join(["nothing was imported:", *(f"{at.en}: {why.en}" for at, why in rows)]),
                "\n".join(["没有导入任何人：", *(f"{at.zh}：{why.zh}" for at, why in rows)]),
            )
        return self.entries

    def without(self, wrong: Mapping[str, Text]) -> "Roster":
        """Return the list with more rows that cannot be imported: those of the ids in `wrong`, for its reasons."""
        rows = [SkippedRow(place=self.places[person], reason=why) for person, why in wrong.items()]
        entries = tuple(entry for entry in self.entries if entry.id not in wrong)
        skipped = sorted((*self.skipped, *rows), key=lambda one: (one.place.sheet, one.place.number))
        return replace(self, entries=entries, skipped=tuple(skipped))

    def restoring(self, whole: Mapping[str, str]) -> "Roster":
        """Return the list with the ids in `whole`, by the ones that are written, in their places."""
        rows = [
            RestoredRow(place=self.places[written], written=written, id=id_) for written, id_ in whole.items()
        ]
        return replace(
            self,
            entries=tuple(replace(one, id=whole.get(one.id, one.id)) for one in self.entries),
            places={whole.get(id_, id_): place for id_, place in self.places.items()},
            restored=(*self.restored, *rows),
        )


def as_csv(entries: Sequence[RosterEntry]) -> str:
    """Return entries as `read_roster` reads them back."""
    out = io.StringIO()
    table = csv.writer(out, lineterminator="\n")
    table.writerow(("id", "name", "role", "email", "section"))
    for entry in entries:
        table.writerow(
            (entry.id, entry.name, entry.role or "", entry.email or "", "；".join(entry.sections or ()))
        )
    return out.getvalue()


def read_roster(content: bytes) -> Roster:
    """Return the people in a class list: a workbook or CSV, as `grader.formats.sheets.reading` reads them.

    The header stands in one of the first twelve rows and has a column of ids and one of names (or of first and
    last names); columns of e-mail addresses, sections and roles are read as well, others ignored. Titles,
    sub-headers, legends and sums are passed over, and so is the same header again. Of a workbook with a sheet for
    each section, all are read; whose row names no section is in the one that the sheet is named after.

    Raises CourseError: there is no table, no header, or nobody in it.
    """
    table = read_table(content, lambda cells: bool(_columns(cells)))
    _header(table)
    sheets, unread = _sheets(table)
    people = _People(several=len(sheets) > 1)
    for sheet in sheets:
        people.add(sheet)
    people.skipped += unread
    if not people.entries and not people.skipped:
        raise CourseError("the roster names nobody", "名单里没有人")
    return Roster(
        entries=tuple(people.entries),
        places={entry.id: place for place, entry in people.place_of.values()},
        skipped=tuple(people.skipped),
        encoding=table.encoding,
    )


def _sheets(table: ListedTable) -> tuple[list[ListedTable], list[SkippedRow]]:
    """Return the sheets that list people, and a row for each other sheet that has somebody whom these have not.

    A sheet is another part of the list if most of its people are new; with the same people it is something else,
    such as their grades.
    """
    sheets, unread = [table], []
    listed = set(map(folded_id, _ids(table)))
    for other in table.others:
        ids = _ids(other)
        missing = [id_ for id_ in ids if folded_id(id_) not in listed]
        if 2 * len(missing) > len(ids):
            sheets.append(other)
            listed.update(map(folded_id, ids))
        elif missing:
            reason = Text(
                zh=f"工作表“{other.name}”里有 {len(missing)} 人不在前面的工作表里（例如 {missing[0]}）："
                "请把他们加进前面的名单",
                en=f"the sheet {other.name!r} has people who are on no sheet before it, such as {missing[0]} "
                f"({len(missing)} in all): add them to the list there",
            )
            place = RowPlace(sheet=other.name, number=other.rows[_found_header(other)[0] - 1].number)
            unread.append(SkippedRow(place=place, reason=reason))
    return sheets, unread


def _ids(table: ListedTable) -> list[str]:
    start, columns = _found_header(table)
    if not columns:
        return []
    cells = (row.cells[columns["id"]] for row in table.rows[start:] if columns["id"] < len(row.cells))
    ids = (unicodedata.normalize("NFKC", cell).strip() for cell in cells)
    return [id_ for id_ in ids if is_person_id(id_)]


class _People:
    """The people of the tables that were added.

    Args:
        several: there is more than one table, and their names are those of sections.
    """

    def __init__(self, *, several: bool) -> None:
        self._several = several
        self.entries: list[RosterEntry] = []
        self.skipped: list[SkippedRow] = []
        self.place_of: dict[str, tuple[RowPlace, RosterEntry]] = {}

    def add(self, table: ListedTable) -> None:
        """Add whoever stands in a table; rows that name nobody are passed over."""
        start, columns = _header(table)
        width = len(table.rows[start - 1].cells)
        for row in table.rows[start:]:
            place = RowPlace(sheet=table.name if self._several else "", number=row.number)
            try:
                entry = _entry(row, columns)
                if entry is None:
                    continue
                if any(row.cells[width:]):
                    raise _shifted()
                self._check_new(entry)
                entry = _of_sheet(entry, table.name) if self._several else entry
            except CourseError as error:
                self.skipped.append(SkippedRow(place=place, reason=error.text))
            else:
                self.place_of[folded_id(entry.id)] = place, entry
                self.entries.append(entry)

    def _check_new(self, entry: RosterEntry) -> None:
        if folded_id(entry.id) not in self.place_of:
            return
        place, before = self.place_of[folded_id(entry.id)]
        at, name = place.words, f" {before.name}" if before.name != entry.name else ""
        if before.id == entry.id:
            raise CourseError(
                f"{entry.id}{name} stands in {at.en} already", f"{at.zh}已经有 {entry.id}{name}"
            )
        how = difference(entry.id, before.id)
        raise CourseError(
            f"{entry.id} differs from {before.id} in {at.en} only in {how.en}",
            f"{entry.id} 和{at.zh}的 {before.id} {how.zh}",
        )


def _of_sheet(entry: RosterEntry, sheet: str) -> RosterEntry:
    """Return an entry with what the name of its sheet says: a role, or else a section."""
    if role := _ROLES.get(label(sheet)):
        return entry if entry.role else replace(entry, role=Role(role))
    if entry.sections or _UNNAMED_SHEET.fullmatch(label(sheet)):
        return entry
    return replace(entry, sections=_checked_sections(sheet))


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
    candidates = ((index, _columns(row.cells)) for index, row in enumerate(table.rows[:HEADER_ROWS], 1))
    return next(((start, columns) for start, columns in candidates if columns), (0, {}))


def _columns(cells: Sequence[str]) -> dict[str, int]:
    """Return the index of each column that a header has; nothing if ids or names are missing."""
    labels = [label(cell) for cell in cells]
    columns: dict[str, int] = {}
    for column in _COLUMNS:
        index = _index_of(column, labels)
        if index is not None and index not in columns.values():
            columns[column] = index
    named = "name" in columns or {"first", "last"} <= columns.keys()
    return columns if named and "id" in columns else {}


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
    # else a sum is imported as a student's id; somebody with a name may really be called Sum
    is_sum = (not name or name.isdecimal()) and any(label(cell) in _SUMS for cell in row.cells)
    if is_sum or _SUM_FOR_AN_ID.fullmatch(person):
        return None
    if not person:
        raise CourseError(f"no id beside the name {name[:40]}", f"“{name[:40]}”没有学号")
    email = cells.get("email", "")
    return RosterEntry(
        id=_checked_student(person),
        name=person_name(name),
        role=_checked_role(cells.get("role", "")),
        email=checked_email(email) if email else None,
        sections=_checked_sections(cells.get("sections", "")),
    )


def _joined(first: str, last: str) -> str:
    """Return a full name: in Chinese, Japanese and Korean characters the last name comes first."""
    if any(unicodedata.east_asian_width(character) in "WF" for character in first + last):
        return f"{last}{first}"
    return f"{first} {last}".strip()


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
        roles = ", ".join(Role)
        raise CourseError(f"{text!r} is no role: use {roles}", f"没有角色 {text!r}：只能用 学生、助教、教师")
    return Role(role) if role else None


def _checked_sections(text: str) -> tuple[str, ...] | None:
    """Return the sections that a cell names, None where it names none."""
    named = [checked_section(section) for section in _SECTION_SEPARATOR.split(text) if section.strip()]
    return tuple(dict.fromkeys(named)) or None
