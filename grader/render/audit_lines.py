"""Entries of the audit log in words: what was done to what, and what is different since.

Entries are kept for ever, whatever wrote them: what has no words here is shown as it stands.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any
from zoneinfo import ZoneInfo

from grader.contracts import fields
from grader.contracts.fields import FieldKind, kinds_of
from grader.contracts.identity import Role
from grader.contracts.notation import written
from grader.contracts.rules import LATE_PARAMETERS, Extension, LateRule, Rules
from grader.contracts.text import Language
from grader.messages import is_on_page, on_page

ACTIONS = (
    "course.create", "course.change", "course.copy", "course.archive", "course.reopen", "course.retain",
    "member.add", "member.change", "member.remove", "member.renumber", "member.forget",
    "token.issue", "token.revoke",
    "signin.bind", "signin.unbind", "platform.invite", "platform.add", "platform.remove",
    "webhook.set", "webhook.remove", "mail.set",
    "rules.change", "extension.change", "submission.hand_in",
    "grade.judge", "grade.change", "regrade.applied", "regrade.discarded", "regrade.undone",
    "team.change", "team.set",
    "appeal.make", "appeal.withdraw", "appeal.pass_on", "appeal.answered", "appeal.corrected", "appeal.refused",
    "assignment.upload", "assignment.remove",
)  # fmt: skip
KINDS = ("assignment", "course", "item", "member", "platform", "submission", "token", "webhook")
_RULES = {**kinds_of(Rules), **kinds_of(Extension)}
_KINDS: Mapping[str, FieldKind] = {
    **_RULES,
    "expires_at": fields.Instant(),
    "role": fields.Choice(options=tuple(Role)),
}
FIELDS: Mapping[str, str] = {
    **{name: f"rules.{name}" for name in _RULES},
    "accept_late_s": "audit.field.accept_late",
    "hidden_items": "rules.heading.hidden_items",
    "points": "audit.field.points",
    "comment": "audit.field.comment",
    "score": "score",
    "judgements kept": "audit.field.kept",
    "judgements void": "audit.field.void",
    "title": "audit.field.title",
    "time_zone": "audit.field.time_zone",
    "distro": "audit.field.distro",
    "runs_as": "audit.field.runs_as",
    "session_hours": "rules.session_hours",
    "name": "people.name",
    "role": "people.role",
    "email": "people.email",
    "sections": "people.sections",
    "token": "enter.token",
    "provider": "audit.field.provider",
    "subject": "audit.field.subject",
    "issuer": "platforms.field.issuer",
    "client_id": "platforms.field.client_id",
    "vendor": "notices.vendor",
    "host": "notices.host",
    "signed": "notices.signed",
    "graded": "notices.kind.graded",
    "faults": "notices.kind.faults",
    "expires_at": "audit.field.expires_at",
    "copy": "audit.field.copy",
    "submissions": "audit.field.submissions",
    "older_than_days": "audit.field.older_than_days",
    "copy_of": "audit.field.copy_of",
    "open": "audit.field.open",
    "student": "student",
    "team": "team.title",
    "teams": "teams.title",
    "assignment": "assignment",
    "sha256": "audit.field.sha256",
    "version": "audit.field.version",
    "size_bytes": "audit.field.size_bytes",
}
_LONGEST_SHOWN = 400
_UNITS = ((86_400, "audit.days"), (3_600, "audit.hours"), (60, "audit.minutes"), (1, "audit.seconds"))


@dataclass(frozen=True, slots=True)
class Teller:
    """Tells entries in `language`, instants on the clock of `zone`."""

    language: Language
    zone: ZoneInfo

    def actor(self, name: str) -> str:
        """Return who did it: a member, or a user of the machine as `grader.commands` writes it."""
        user = name.removeprefix("command line (")
        return (
            name
            if user == name
            else on_page(self.language, "audit.command_line", user=user.removesuffix(")"))
        )

    def action(self, name: str) -> str:
        """Return what was done."""
        return self._word(f"audit.action.{name}", name)

    def subject(self, text: str) -> str:
        """Return what it was done to; `text` is as `grader.store` writes it: kinds and names."""
        return on_page(self.language, "comma").join(self._part(part) for part in text.split(", "))

    def differences(self, before: Any, after: Any) -> list[tuple[str, str, str]]:
        """Return what changed as name, text before and text after; only the fields that differ of two records."""
        if not (isinstance(before, dict) or isinstance(after, dict)):
            return [("", _text(before), _text(after))]
        old, new = (value if isinstance(value, dict) else {} for value in (before, after))
        return [
            (
                self._word(FIELDS.get(name, ""), name),
                self.value(name, old.get(name)),
                self.value(name, new.get(name)),
            )
            for name in dict.fromkeys([*old, *new])
            if old.get(name) != new.get(name) and not (_empty(old.get(name)) and _empty(new.get(name)))
        ]

    def value(self, name: str, value: Any) -> str:
        """Return the value of the field `name` in words, as it stands when it is not what such fields hold."""
        if _empty(value):
            return _text(value)
        try:
            return self._in_words(name, _KINDS.get(name), value)
        except (LookupError, TypeError, ValueError, AttributeError):
            return _text(value)

    def _part(self, part: str) -> str:
        kind, _, name = part.partition(" ")
        if kind == "regrade":
            id_, _, assignment = name.partition(" of ")
            return on_page(self.language, "audit.kind.regrade", assignment=assignment, id=id_)
        return f"{self._word(f'audit.kind.{kind}', kind)} {name}" if name else part

    def _word(self, key: str, otherwise: str) -> str:
        return on_page(self.language, key) if is_on_page(key) else otherwise

    def _instant(self, value: str) -> str:
        return (
            datetime.fromisoformat(value)
            .astimezone(self.zone)
            .strftime("%Y-%m-%d %H:%M:%S")
            .removesuffix(":00")
        )

    def _span(self, seconds: int) -> str:
        parts, rest = [], int(seconds)
        for unit_s, key in _UNITS:
            count, rest = divmod(rest, unit_s)
            if count:
                parts.append(on_page(self.language, key, count=count))
        return " ".join(parts) or on_page(self.language, "audit.seconds", count=0)

    def late(self, late: Mapping[str, Any], *, in_full: bool) -> str:
        """Return what lateness costs by the JSON of a late rule; `in_full`: with every line of its table."""
        kinds, chosen = kinds_of(LateRule), late["kind"]
        parameters = {name: self._in_words(name, kinds[name], late[name]) for name in LATE_PARAMETERS[chosen]}
        tables = [text for name, text in parameters.items() if isinstance(kinds[name], fields.Table)]
        return (
            tables[0]
            if in_full and tables
            else on_page(self.language, f"rules.late_short.{chosen}", **parameters)
        )

    def _in_words(self, name: str, kind: FieldKind | None, value: Any) -> str:
        match kind:
            case _ if value is None:
                return _text(value)
            case fields.Instant():
                return self._instant(value)
            case fields.Seconds():
                return self._span(value)
            case fields.Share():
                return written(round(value * 100, 9))
            case fields.Choice():
                return on_page(self.language, f"{'people' if name == 'role' else 'rules'}.{name}.{value}")
            case fields.Nested():
                return self.late(value, in_full=True)
            case fields.Table():
                return on_page(self.language, "comma").join(self._line(name, kind, line) for line in value)
            case _:
                return _text(value)

    def _line(self, name: str, kind: fields.Table, line: Mapping[str, Any]) -> str:
        values = {part: self._in_words(part, of, line[part]) for part, of in kinds_of(kind.of).items()}
        return on_page(self.language, f"rules.{name}.line", **values)


def _empty(value: Any) -> bool:
    return value is None or value in ([], "")


def _text(value: Any) -> str:
    if _empty(value):
        return "—"
    if isinstance(value, float):
        return written(value)
    if isinstance(value, list) and all(isinstance(element, str) for element in value):
        value = ", ".join(value)
    text = value if isinstance(value, str) else json.dumps(value, ensure_ascii=False, sort_keys=True)
    return text if len(text) <= _LONGEST_SHOWN else text[:_LONGEST_SHOWN] + "…"
