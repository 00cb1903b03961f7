"""Everything of a course in one zip: sources, reports, grades, comments, the audit log, and a manifest.

It is made while it is sent, submission by submission, so that its size does not matter: what is kept meanwhile
is the list of its files. It is not the picture of one instant; the manifest says when it was begun.
"""

import hashlib
import json
import zipfile
from collections.abc import Iterator
from dataclasses import asdict, replace
from datetime import datetime
from typing import Any

from grader.contracts.identity import Caller, Course
from grader.contracts.submission import Submission
from grader.formats.packages.bundle import is_package
from grader.formats.sheets.writing import csv_table
from grader.store.rules import to_document
from grader.use_cases.callers import require_instructor
from grader.use_cases.course_life import own_course
from grader.use_cases.gradebook import gradebook_csv
from grader.use_cases.services import Services

_AT_ONCE = 200
_MANIFEST = "manifest.json"


def export(services: Services, caller: Caller) -> Iterator[bytes]:
    """Return the zip part by part. For instructors of a course."""
    require_instructor(caller)
    course = own_course(services, caller)
    return _Export(services, caller, course).parts()


class _Taken:
    """A file that can only be written; what was written is taken from it.

    Nobody closes it: the garbage collector would close one of `io` while an export that nobody reads is open.
    """

    def __init__(self) -> None:
        self._parts: list[bytes] = []

    def write(self, data: Any) -> int:
        self._parts.append(bytes(data))
        return len(data)

    def flush(self) -> None:
        """Do nothing; `zipfile` asks for it."""

    def close(self) -> None:
        """Do nothing; `zipfile` asks for it."""

    def take(self) -> bytes:
        parts, self._parts = self._parts, []
        return b"".join(parts)


class _Export:
    def __init__(self, services: Services, caller: Caller, course: Course) -> None:
        self._services = services
        self._caller = caller
        self._course = course
        self._begun_at = services.clock()
        self._out = _Taken()
        self._zip: zipfile.ZipFile
        self._files: list[dict[str, Any]] = []

    def parts(self) -> Iterator[bytes]:
        """Yield the zip, file by file. A reader that stops early leaves no zip open."""
        with zipfile.ZipFile(self._out, "w", zipfile.ZIP_DEFLATED) as self._zip:
            for name, content in self._of_course():
                yield self._put(name, content, self._begun_at)
            count = 0
            for submission in self._submissions():
                count += 1
                for name, content in self._of_submission(submission):
                    yield self._put(name, content, submission.received_at)
            course = _plain(asdict(self._course))
            manifest = {"course": course, "made_at": self._begun_at.isoformat(), "submissions": count}
            yield self._put(_MANIFEST, _json({**manifest, "files": self._files}), self._begun_at)
        yield self._out.take()

    def _put(self, name: str, content: bytes, at: datetime) -> bytes:
        entry = zipfile.ZipInfo(name, at.timetuple()[:6])
        entry.compress_type = zipfile.ZIP_DEFLATED
        self._zip.writestr(entry, content)
        digest = hashlib.sha256(content).hexdigest()
        self._files.append({"path": name, "bytes": len(content), "sha256": digest})
        return self._out.take()

    def _of_course(self) -> Iterator[tuple[str, bytes]]:
        services, course = self._services, self._course.id
        head = ("id", "name", "role", "email", "sections")
        people = services.courses.members(course)
        rows = [
            (person.id, person.name, person.role.value, person.email, "；".join(person.sections))
            for person in people
        ]
        yield "members.csv", csv_table([head, *rows]).encode()
        yield "gradebook.csv", gradebook_csv(services, self._caller, "plain").encode()
        course_rules = services.rules.of(course)
        extensions = [
            {"assignment": assignment, "student": person, **to_document(one)}
            for (assignment, person), one in sorted(course_rules.extensions.items(), key=lambda pair: pair[0])
        ]
        rules = {name: to_document(one) for name, one in sorted(course_rules.by_assignment.items())}
        yield "rules.json", _json({"rules": rules, "extensions": extensions})
        for name, content in sorted(services.own_assignments.in_use(course).items()):
            yield f"assignments/{name}.zip", content
        yield "audit.json", _json([_plain(asdict(entry)) for entry in self._audit()])

    def _audit(self) -> Iterator[Any]:
        before: int | None = None
        while entries := self._services.audit.entries(self._course.id, _AT_ONCE, before):
            yield from entries
            before = entries[-1].id

    def _submissions(self) -> Iterator[Submission]:
        after: str | None = None
        while page := self._services.submissions.in_order(self._course.id, after, _AT_ONCE):
            yield from page
            after = page[-1].id

    def _of_submission(self, one: Submission) -> Iterator[tuple[str, bytes]]:
        folder = f"submissions/{one.student}/{one.assignment}/{one.id}"
        services = self._services
        stored = services.submissions.report(one.id)
        about = _plain(asdict(replace(one, trouble="")))
        about["judgements"] = [_plain(asdict(given)) for given in (stored.judgements if stored else ())]
        about["comments"] = [_plain(asdict(said)) for said in services.comments.of(one.id)]
        about["appeals"] = [_plain(asdict(asked)) for asked in services.appeals.of(one.id)]
        yield f"{folder}/submission.json", _json(about)
        source = services.submissions.source(one.id) or b""
        suffix = ".zip" if is_package(source) else ".py" if one.file_name.lower().endswith(".py") else ".txt"
        yield f"{folder}/source{suffix}", source
        if stored is not None:
            yield f"{folder}/report.json", stored.content


def _plain(document: dict[str, Any]) -> dict[str, Any]:
    return {name: one.isoformat() if isinstance(one, datetime) else one for name, one in document.items()}


def _json(document: object) -> bytes:
    return json.dumps(document, ensure_ascii=False, indent=1).encode()
