"""Assignments that instructors upload to their course: taken in, shown, downloaded, removed."""

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from grader.catalog import Catalog, default_root
from grader.catalog.authoring import create
from grader.catalog.files import SPEC_NAME
from grader.catalog.refreshed import same_version
from grader.contracts.assignment import Assignment
from grader.contracts.errors import AssignmentError, RefusedError, UnknownAssignmentError
from grader.contracts.identity import Caller
from grader.contracts.own_assignment import Misfit, OwnAssignment, OwnState
from grader.contracts.record import to_plain
from grader.contracts.text import EMPTY, LANGUAGES, Text
from grader.grading.examination.reading import declared_id, misfits_of, read_folder
from grader.grading.examination.reference import wants_reference
from grader.grading.examination.zipped import packed, unpacked
from grader.store.own_assignments import NewOwnAssignment
from grader.use_cases.assignments import is_own
from grader.use_cases.callers import require_instructor, require_staff, taught_course
from grader.use_cases.services import Services


def own_assignments(services: Services, caller: Caller) -> tuple[OwnAssignment, ...]:
    """Return what was uploaded to the caller's course; nothing without courses. For staff."""
    require_staff(caller)
    if caller.course is None:
        return ()
    services.assignments.look_again()  # so that an assignment shown as usable here can be used everywhere
    return services.own_assignments.of(caller.course)


def own_troubles(services: Services, caller: Caller) -> dict[str, Text]:
    """Return by id what is wrong with assignments of the caller's course: that the last upload was refused, too.

    For staff.
    """
    troubles = dict(services.assignments.of(caller.course).troubles())
    for upload in own_assignments(services, caller):
        if upload.state is OwnState.REFUSED:
            lines = [(place_of(misfit), misfit.told) for misfit in upload.examined.misfits]
            lines += [
                (verdict.script, verdict.problem)
                for verdict in upload.examined.verdicts
                if verdict.problem != EMPTY
            ]
            troubles[upload.assignment] = _listed(lines)
    return troubles


def upload(services: Services, caller: Caller, content: bytes) -> OwnAssignment:
    """Read an assignment's folder and keep it until a worker has run its scripts; then the course can use it.

    Raises:
        RefusedError: the caller is no instructor, there is no course, it is archived, or the folder is not what
            an assignment's must be: `errors` then names file, line and field of each problem.
        InfrastructureError: the folder could not be read, through no fault of its own.
    """
    course = taught_course(caller)
    try:
        files = unpacked(content)
    except AssignmentError as error:
        raise _refused(misfits_of(error)) from None
    reading = read_folder(files)
    if reading.assignment is None:
        raise _refused(reading.misfits)
    _require_fit(services, caller, reading.assignment)
    new = NewOwnAssignment(
        draft=is_own(services, course, reading.assignment.id),
        assignment=reading.assignment.id,
        version=reading.assignment.version,
        content=packed(declared_id(files), files),
        reading=json.dumps(reading, default=to_plain).encode(),
    )
    services.own_assignments.add(new, services.signature(caller))
    services.doorbell.ring()
    return next(
        own for own in reversed(services.own_assignments.of(course)) if own.assignment == new.assignment
    )


def folder(services: Services, caller: Caller, assignment_id: str) -> bytes:
    """Return the folder that was uploaded last, as a zip.

    Raises RefusedError: the caller is no instructor, or nothing of that id was uploaded.
    """
    require_instructor(caller)
    content = (
        None if caller.course is None else services.own_assignments.content(caller.course, assignment_id)
    )
    if content is None:
        raise RefusedError("assignment_not_found")
    return content


def template(services: Services, caller: Caller, name: str, like: str) -> bytes:
    """Return the folder of a new assignment as a zip: an example, or a copy of the shipped one of the id `like`.

    Raises:
        RefusedError: the caller is no instructor, or `name` cannot be an id, or nothing shipped is called `like`.
    """
    require_instructor(caller)
    shipped = {one.name: one for one in default_root().iterdir() if (one / SPEC_NAME).is_file()}
    if like and like not in shipped:
        raise RefusedError("assignment_not_found")
    with TemporaryDirectory() as place:
        try:
            folder = create(Catalog(Path(place)), name, shipped.get(like))
        except AssignmentError as error:
            raise RefusedError("invalid_request", error.text, field="id") from None
        paths = sorted(path for path in folder.rglob("*") if path.is_file())
        return packed(name, {path.relative_to(folder).as_posix(): path.read_bytes() for path in paths})


def remove(services: Services, caller: Caller, assignment_id: str, reason: str) -> None:
    """Remove an uploaded assignment for which nothing was handed in, or which stands in the place of another.

    Raises RefusedError: the caller is no instructor, there is none of that id, or something was handed in.
    """
    course = taught_course(caller)
    replaces = not is_own(services, course, assignment_id)
    services.own_assignments.remove(assignment_id, services.signature(caller), reason, in_use=replaces)


def _require_fit(services: Services, caller: Caller, new: Assignment) -> None:
    """Refuse a rubric that was changed under its version."""
    catalog = services.assignments.of(caller.course)
    try:
        before = catalog.get(new.id)
    except UnknownAssignmentError:
        return
    # What its solution drives is found out by running it.
    if before.path is not None and wants_reference(new):
        before = replace(before, path=replace(before.path, trace=()))
    error = same_version(before, new)
    if error is not None:
        raise _refused((Misfit(file=SPEC_NAME, field="version", told=error.text),))


def _refused(misfits: tuple[Misfit, ...]) -> RefusedError:
    detail = _listed([(place_of(misfit), misfit.told) for misfit in misfits])
    return RefusedError("invalid_assignment", detail, field="file", misfits=misfits)


def _listed(lines: Sequence[tuple[str, Text]]) -> Text:
    """Return several texts as lines of one, each behind its place."""
    texts = {
        language: "\n".join(f"{place}: {told.get(language)}" for place, told in lines)
        for language in LANGUAGES
    }
    return Text(**texts)


def place_of(one: Misfit) -> str:
    """Return file, line and field of a problem, as far as they are known."""
    file = one.file if one.line is None else f"{one.file}:{one.line}"
    return f"{file}: {one.field}" if one.field else file
