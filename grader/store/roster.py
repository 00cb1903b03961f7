"""Reading a class list: CSV with a header line, columns ``id``, ``name`` and optionally ``role``."""

import csv
import io
import re
from typing import Any

from grader.contracts.errors import CourseError
from grader.contracts.identity import Role, RosterEntry, checked_id, checked_name
from grader.contracts.text import Text

_REQUIRED = ("id", "name")
_KNOWN = (*_REQUIRED, "role")
_COLUMNS = {"学号": "id", "姓名": "name", "角色": "role"}
_ROLES = {
    "学生": Role.STUDENT.value,
    "助教": Role.ASSISTANT.value,
    "教师": Role.INSTRUCTOR.value,
    "老师": Role.INSTRUCTOR.value,
}
_IN_CHINESE = {column: name for name, column in _COLUMNS.items()}
_SHORTENED = re.compile(r"[0-9][.,]?[0-9]*e[+][0-9]+", re.IGNORECASE)
MAX_ROSTER_BYTES = 4 * 1024 * 1024


def read_roster(content: bytes) -> tuple[RosterEntry, ...]:
    """Return the entries of a roster in order.

    UTF-8, with or without a byte order mark, or GBK, as Excel in China saves CSV; columns of other names are
    ignored. Columns and roles may have their Chinese names, as on the pages.

    Raises:
        CourseError: the file is not right; the message has a line for each line of the file that is wrong.
    """
    if len(content) > MAX_ROSTER_BYTES:
        raise CourseError(
            f"the roster has more than {MAX_ROSTER_BYTES} bytes", f"名单超过 {MAX_ROSTER_BYTES} 字节"
        )
    text = _decoded(content)
    reader = csv.DictReader(io.StringIO(text, newline=""), strict=True)
    columns = [name.strip().lower() for name in reader.fieldnames or ()]
    reader.fieldnames = [_COLUMNS.get(name, name) for name in columns]
    _check_header(reader.fieldnames)
    return _entries(reader)


def is_utf8(content: bytes) -> bool:
    """Whether a roster is UTF-8, so that its names are certainly as they were written."""
    try:
        content.decode()
    except UnicodeDecodeError:
        return False
    return True


def _decoded(content: bytes) -> str:
    if is_utf8(content):
        return content.decode("utf-8-sig")
    try:
        return content.decode("gb18030")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise CourseError(
            f"line {line}: neither UTF-8 nor GBK: save the roster as CSV UTF-8",
            f"第 {line} 行：不是 UTF-8 也不是 GBK 编码：请把名单另存为“CSV UTF-8”",
        ) from None


def _check_header(columns: list[str]) -> None:
    missing = [name for name in _REQUIRED if name not in columns]
    if missing:
        raise CourseError(
            f"line 1: no column {missing[0]!r}: the first line names the columns id,name,role",
            f"第 1 行：缺少“{_IN_CHINESE[missing[0]]}”列：第一行要写列名 学号,姓名,角色，用英文逗号隔开",
        )
    twice = [name for name in _KNOWN if columns.count(name) > 1]
    if twice:
        raise CourseError(f"line 1: two columns {twice[0]!r}", f"第 1 行：有两个“{_IN_CHINESE[twice[0]]}”列")


def _entries(reader: "csv.DictReader[str]") -> tuple[RosterEntry, ...]:
    entries: list[RosterEntry] = []
    problems: list[Text] = []
    first_line: dict[str, int] = {}
    try:
        for row in reader:
            line = reader.line_num
            if _blank(row):
                continue
            try:
                entry = _entry(row)
                if entry.id in first_line:
                    before = first_line[entry.id]
                    raise CourseError(
                        f"{entry.id} stands in line {before} already", f"第 {before} 行已经有 {entry.id}"
                    )
            except CourseError as error:
                problems.append(_at(line, error.told("zh"), error.told("en")))
            else:
                first_line[entry.id] = line
                entries.append(entry)
    except csv.Error as error:
        problems.append(_at(reader.line_num, str(error), str(error)))
    if problems:
        raise CourseError(
            "\n".join(["nothing was imported:", *(one.en for one in problems)]),
            "\n".join(["没有导入任何人：", *(one.zh for one in problems)]),
        )
    if not entries:
        raise CourseError("the roster names nobody", "名单里没有人")
    return tuple(entries)


def _at(line: int, zh: str, en: str) -> Text:
    return Text(zh=f"第 {line} 行：{zh}", en=f"line {line}: {en}")


def _checked_student(text: str) -> str:
    if _SHORTENED.fullmatch(text):
        raise CourseError(
            f"{text} is a number that a spreadsheet shortened: format the column as text, fill it in again",
            f"{text} 是被表格软件改成科学计数法的学号：把这一列设为“文本”，重新填写学号",
        )
    return checked_id(text, "id")


def _blank(row: dict[str | Any, str | Any]) -> bool:
    """Whether nothing stands in a line but commas, as spreadsheets leave lines that were emptied."""
    return not any("".join(cells or ()).strip() for cells in row.values())


def _entry(row: dict[str | Any, str | Any]) -> RosterEntry:
    if any(cell.strip() for cell in row.get(None, ())):  # where the reader puts what no column is for
        raise CourseError(
            "more cells than columns: put quotes around a name with a comma",
            "单元格比列多：名字里有逗号时要加引号",
        )
    role = (row.get("role") or "").strip().lower()
    role = _ROLES.get(role, role)
    if role and role not in list(Role):
        known = ", ".join(Role)
        raise CourseError(f"{role!r} is no role: use {known}", f"没有角色 {role!r}：只能用 学生、助教、教师")
    return RosterEntry(
        id=_checked_student((row["id"] or "").strip()),
        name=checked_name(row["name"] or ""),
        role=Role(role) if role else None,
    )
