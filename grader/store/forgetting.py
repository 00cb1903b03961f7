"""Forgetting a person: what they handed in is erased, and a pseudonym stands where their id stood.

Free texts and the audit log are searched for the id, for every name and address that the course knew them by.
"""

import json
import re
import secrets
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Final

from sqlalchemy import Column, ColumnElement, Table, Text, or_, select, update
from sqlmodel import Session, SQLModel, col

from grader.store.tables import AuditRow, MemberRow, PlainText, SubmissionRow

_ID_BYTES = 4
_LEAST = 2  # characters of a name that is searched for
_NOTHING = "null"
NAMES_NOBODY: Final = frozenset(
    ("rules.document", "grading.measurements", "submission.trouble", "token.opened_by", "course.begun_with")
)
"""Columns that the grader alone fills, without naming a person. Every other text is searched, also one of a new
column."""
_DOCUMENTS = ("wanted", "outcome", "change")
"""Columns of JSON that the grader reads again: there a person is named by the id alone, as a whole text."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Forgotten:
    """Who is now called `pseudonym`, and how many submissions were erased."""

    pseudonym: str
    submissions: int


def new_pseudonym() -> str:
    """Return a name that tells nothing about a person."""
    return f"forgotten-{secrets.token_hex(_ID_BYTES)}"


def is_known(session: Session, course: str, person: str) -> bool:
    """Return whether anything of the course names a person, who may have been removed."""
    places = (
        select(col(MemberRow.person)).where(col(MemberRow.course) == course, col(MemberRow.person) == person),
        select(col(SubmissionRow.id)).where(
            col(SubmissionRow.course) == course, col(SubmissionRow.student) == person
        ),
        select(col(AuditRow.id)).where(_about(course, person)),
    )
    return any(session.execute(place.limit(1)).first() is not None for place in places)


def rename_everywhere(
    session: Session, course: str, person: str, pseudonym: str, names: Iterable[str]
) -> Callable[[str], str]:
    """Put `pseudonym` where the course's rows name `person`; return what does so with a text.

    What the person handed in is erased by then. Entries of the audit log about them lose what they say.
    """
    scrub = _scrubber(names, pseudonym)
    about = _about(course, person)
    blank = {"before": _NOTHING, "after": _NOTHING, "reason": ""}
    named = [col(AuditRow.subject) == f"member {person}"]
    session.execute(update(AuditRow).where(about, *named).values(blank))
    session.execute(update(AuditRow).where(about).values(reason=""))
    for table in SQLModel.metadata.sorted_tables:
        if (own := _of_course(table, course)) is not None:
            _rename(session, table, own, (person, pseudonym), scrub)
    return scrub


def give_new_id(session: Session, course: str, person: str, new: str) -> None:
    """Put the id `new` where the course's rows name a member `person` by the id alone; texts stay as they are.

    The member's own row is the caller's to exchange: `new` must be a member by then.
    """
    subject = _scrubber({person}, new)
    for table in SQLModel.metadata.sorted_tables:
        if table.name == MemberRow.__tablename__ or (own := _of_course(table, course)) is None:
            continue
        for name in ("person", "student"):
            if name in table.c:
                column: Column[Any] = table.c[name]
                session.execute(update(table).where(own, column == person).values({name: new}))
        _rename(session, table, own, (person, new), subject, only=("subject", *_DOCUMENTS))


def _rename(  # noqa: PLR0913
    session: Session,
    table: Table,
    own: ColumnElement[bool],
    renamed: tuple[str, str],
    scrub: Callable[[str], str],
    *,
    only: Sequence[str] = (),
) -> None:
    """Rename in a table's columns of ids, and in its texts; `only`: in those of these names."""
    person, pseudonym = renamed
    ids, texts = naming_columns(table)
    for column in ids:
        session.execute(update(table).where(own, column == person).values({column.name: pseudonym}))
    texts = [one for one in texts if not only or one.name in only]
    if not texts:
        return
    keys = list(table.primary_key.columns)
    for row in session.execute(select(*keys, *texts).where(own)).all():
        values = row._asdict()
        changed = {
            one.name: new
            for one in texts
            if (old := values[one.name])
            and (new := _renamed(old, renamed) if one.name in _DOCUMENTS else scrub(old)) != old
        }
        if changed:
            session.execute(update(table).where(*(key == values[key.name] for key in keys)).values(changed))


def naming_columns(table: Table) -> tuple[list[Column[Any]], list[Column[Any]]]:
    """Return the columns that hold nothing but the id of whoever did something, and those of texts to search."""
    searched = [column for column in table.c if str(column) not in NAMES_NOBODY]
    ids = [column for column in searched if column.name.endswith("_by") or column.name == "actor"]
    texts = [
        column for column in searched if isinstance(column.type, PlainText | Text) or column.name == "subject"
    ]
    return ids, texts


def _of_course(table: Table, course: str) -> ColumnElement[bool] | None:
    """Return which rows of a table are of the course; None: no row is of any."""
    if "course" in table.c:
        column: Column[Any] = table.c.course
        return column == course
    if "submission_id" in table.c:
        theirs = select(col(SubmissionRow.id)).where(col(SubmissionRow.course) == course)
        return table.c.submission_id.in_(theirs)
    return None


def _about(course: str, person: str) -> ColumnElement[bool]:
    """Return which entries of the audit log name a person as what was changed."""
    subject = col(AuditRow.subject)
    names = or_(subject == f"member {person}", subject.endswith(f", member {person}", autoescape=True))
    return (col(AuditRow.course) == course) & names


def known_as(session: Session, course: str, person: str) -> set[str]:
    """Return the id, and every name and e-mail address that the course knew a person by."""
    names = {person}
    row = session.get(MemberRow, (course, person))
    if row is not None:
        names |= {row.name, row.email}
    entries = session.execute(select(AuditRow.before, AuditRow.after).where(_about(course, person)))  # type: ignore[call-overload]
    for document in (json.loads(text) for entry in entries for text in entry):
        if isinstance(document, dict):
            names |= {str(document.get(name) or "") for name in ("id", "name", "email")}
    return {name for name in names if len(name) >= _LEAST or name == person}


def _renamed(document: str, renamed: tuple[str, str]) -> str:
    person, pseudonym = renamed
    return json.dumps(_walked(json.loads(document), lambda one: pseudonym if one == person else one))


def _scrubber(names: Iterable[str], pseudonym: str) -> Callable[[str], str]:
    longest_first = sorted(names, key=len, reverse=True)
    pattern = re.compile("|".join(_whole(name) for name in longest_first), re.IGNORECASE)

    def scrub(text: str) -> str:
        if text[:1] in ("{", "[", '"'):
            try:
                document = json.loads(text)
            except ValueError:
                return pattern.sub(pseudonym, text)
            changed = _walked(document, lambda one: pattern.sub(pseudonym, one))
            if changed != document:
                return json.dumps(changed, ensure_ascii=False, sort_keys=True)
            return text
        return pattern.sub(pseudonym, text)

    return scrub


def _whole(name: str) -> str:
    """Return the pattern of a name that is no part of a longer word."""
    start = r"(?<![A-Za-z0-9])" if name[:1].isascii() and name[:1].isalnum() else ""
    end = r"(?![A-Za-z0-9])" if name[-1:].isascii() and name[-1:].isalnum() else ""
    return start + re.escape(name) + end


def _walked(document: Any, change: Callable[[str], str]) -> Any:
    match document:
        case str():
            return change(document)
        case list():
            return [_walked(value, change) for value in document]
        case dict():
            return {name: _walked(one, change) for name, one in document.items()}
        case _:
            return document
