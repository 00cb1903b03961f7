"""A course's own points, bands and texts for an assignment that every course has.

The change is an upload of the assignment's folder with another ``assignment.yaml`` and the next version. It is
examined like every upload, and stands in the place of the shared one in this course alone.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import yaml

from grader.catalog.files import SPEC_NAME
from grader.contracts.assignment import Assignment
from grader.contracts.errors import RefusedError
from grader.contracts.identity import Caller
from grader.contracts.own_assignment import OwnAssignment, OwnState
from grader.contracts.text import EMPTY, Text
from grader.grading.examination.reading import read_folder
from grader.grading.examination.zipped import packed, unpacked
from grader.use_cases.assignments import require_published
from grader.use_cases.callers import taught_course
from grader.use_cases.own_assignments import folder, own_assignments, upload
from grader.use_cases.services import Services


@dataclass(frozen=True, slots=True, kw_only=True)
class NewItem:
    """What an item of the rubric is to be. `low`, `high`: the band of full credit; None: open on that side."""

    title: Text
    points: float
    low: float | None
    high: float | None
    ramp: float


def change_rubric(
    services: Services,
    caller: Caller,
    assignment_id: str,
    brief: Text,
    items: Sequence[NewItem],
) -> OwnAssignment:
    """Keep a changed rubric until a worker has examined it; then the course uses it. `items`: in its order.

    Raises:
        RefusedError: the caller is no instructor, there is no such assignment or no folder of it, another rubric
            came meanwhile, or the file would not be what an assignment's must be: `errors` names the fields.
    """
    taught_course(caller)
    assignment = require_published(services, caller, assignment_id)
    files = services.assignments.of(caller.course).files(assignment_id)
    if SPEC_NAME not in files:
        raise RefusedError("assignment_not_found")
    spec: dict[str, Any] = yaml.safe_load(files[SPEC_NAME])
    if len(items) != len(spec["items"]):
        raise RefusedError("changed_meanwhile")
    uploads = [
        upload.version for upload in own_assignments(services, caller) if upload.assignment == assignment_id
    ]
    spec["version"] = max(assignment.version, *uploads, 0) + 1
    spec["brief"] = _languages(brief)
    for item, change in zip(spec["items"], items, strict=True):
        _change(item, change)
    _widen(spec)
    return _uploaded(services, caller, assignment_id, files, spec)


def adopt_scores(services: Services, caller: Caller, assignment_id: str) -> OwnAssignment:
    """Upload a refused folder again, in which the wrong attempts are to get what they got.

    Bounds that do not hold the score become the score, and a mistake that was not recognised is wanted no more.

    Raises RefusedError: as `own_assignments.upload`, or the latest upload of that id was not refused.
    """
    refused = refused_upload(services, caller, assignment_id)
    if refused is None:
        raise RefusedError("assignment_not_found")
    files = unpacked(folder(services, caller, assignment_id))
    spec: dict[str, Any] = yaml.safe_load(files[SPEC_NAME])
    scores = {
        verdict.script: verdict.score for verdict in refused.examined.verdicts if verdict.problem != EMPTY
    }
    for attempt in spec.get("wrong", ()):
        score = scores.get(f"wrong/{attempt['file']}")
        if score is not None:
            low, high = attempt["score"]
            attempt["score"] = [low, high] if low <= score <= high else [_number(score), _number(score)]
            attempt.pop("mistake", None)
    return _uploaded(services, caller, assignment_id, files, spec)


def refused_upload(services: Services, caller: Caller, assignment_id: str) -> OwnAssignment | None:
    """Return the latest upload of an assignment where its scripts did not get what they must. For staff."""
    uploads = [own for own in own_assignments(services, caller) if own.assignment == assignment_id]
    return uploads[-1] if uploads and uploads[-1].state is OwnState.REFUSED else None


def last_saved(services: Services, caller: Caller, assignment: Assignment) -> Assignment:
    """Return the rubric that was saved last: `assignment`, or what was refused since. For staff."""
    if not caller.is_instructor or refused_upload(services, caller, assignment.id) is None:
        return assignment
    saved = read_folder(unpacked(folder(services, caller, assignment.id))).assignment
    fits = saved is not None and [item.id for item in saved.items] == [item.id for item in assignment.items]
    return saved if saved is not None and fits else assignment


def is_changed(services: Services, caller: Caller, assignment: Assignment) -> bool:
    """Return whether the course has a rubric of its own for an assignment that every course has."""
    shared = {one.id: one for one in services.assignments.of(None).all()}
    return assignment.id in shared and shared[assignment.id] != assignment


def _change(item: dict[str, Any], change: NewItem) -> None:
    item["title"], item["points"] = _languages(change.title), _number(change.points)
    for name, value in (("low", change.low), ("high", change.high), ("ramp", change.ramp or None)):
        if value is None:
            item.pop(name, None)
        else:
            item[name] = _number(value)


def _uploaded(
    services: Services,
    caller: Caller,
    assignment_id: str,
    files: Mapping[str, bytes],
    spec: Mapping[str, Any],
) -> OwnAssignment:
    text = yaml.safe_dump(spec, allow_unicode=True, sort_keys=False, width=120)
    return upload(services, caller, packed(assignment_id, {**files, SPEC_NAME: text.encode()}))


def _widen(spec: Mapping[str, Any]) -> None:
    """Let wrong attempts score anything but full marks: what was wanted of them fits the old rubric."""
    most = sum(item["points"] for item in spec["items"])
    for attempt in spec.get("wrong", ()):
        attempt["score"] = [0, _number(most)]
        attempt.pop("mistake", None)


def _languages(text: Text) -> dict[str, str]:
    return {"zh": text.zh, "en": text.en}


def _number(value: float) -> float | int:
    return int(value) if value == int(value) else value
