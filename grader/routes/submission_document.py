"""Filling in what the interface shows of a submission: in one language, bounded, with nothing invisible in it."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from grader.contracts.judgement import judged
from grader.contracts.outcome import RunStatus
from grader.contracts.submission import StoredReport, Submission
from grader.contracts.text import Language
from grader.render.escape import visible
from grader.routes.submission_views import (
    SUBMISSIONS,
    Links,
    Receipt,
    RubricItemView,
    RunView,
    StreamView,
    StudentErrorView,
    SubmissionView,
)
from grader.store.rules import CourseRules

SHOWN_CHARACTERS = 16_384
SHOWN_LOGS = 200


@dataclass(frozen=True, slots=True)
class Place:
    """Where a submission stands in the queue."""

    position: int | None
    estimated_finish_at: datetime | None


def receipt(submission: Submission, *, repeated: bool) -> Receipt:
    """Return what an upload is answered with."""
    return Receipt(
        id=submission.id,
        status=submission.state,
        status_url=SUBMISSIONS + submission.id,
        assignment=submission.assignment,
        student=submission.student,
        sha256=submission.sha256,
        received_at=submission.received_at,
        repeated=repeated,
    )


def view(
    submission: Submission,
    stored: StoredReport | None,
    place: Place,
    known: CourseRules,
    language: Language,
) -> SubmissionView:
    """Return a submission and its latest grading in `language`, judged by the rules of its course."""
    report = {} if stored is None else _whole(stored)
    return SubmissionView(
        id=submission.id,
        student=submission.student,
        assignment=submission.assignment,
        file_name=submission.file_name,
        sha256=submission.sha256,
        size_bytes=submission.size_bytes,
        status=submission.state,
        queue_position=place.position,
        estimated_finish_at=place.estimated_finish_at,
        received_at=submission.received_at,
        queued_at=submission.queued_at,
        started_at=submission.started_at,
        finished_at=submission.finished_at,
        tries=submission.tries,
        verdict=submission.verdict,
        score=submission.score,
        to_judge=submission.to_judge,
        max_score=submission.max_score,
        **lateness(submission, known),
        summary=_said(report.get("summary"), language),
        hint=_said(report.get("hint"), language),
        mistakes=report.get("mistakes", []),
        rubric=[_item(item, language) for item in report.get("items", [])],
        runs=[_run(run) for run in report.get("runs", [])],
        report_sha256=submission.report_sha256,
        graded_at=None if stored is None else stored.finished_at,
        grader_version=report.get("grader_version"),
        assignment_version=report.get("assignment_version"),
        links=_links(SUBMISSIONS + submission.id),
    )


def _links(own: str) -> Links:
    return Links(self=own, report=f"{own}/report", trajectory=f"{own}/trajectory", plot=f"{own}/plot.png")


def _whole(stored: StoredReport) -> Mapping[str, Any]:
    return judged(stored).to_dict() if stored.judgements else dict(json.loads(stored.content))


def lateness(submission: Submission, known: CourseRules) -> dict[str, Any]:
    """Return the fields that tell how late a submission is and what lateness leaves of its score."""
    rules = known.of(submission.assignment)
    extension = known.extension(submission.assignment, submission.student)
    share = rules.kept_share(extension, submission.received_at)
    score = submission.score
    kept = None if score is None else rules.kept_score(extension, score, submission.received_at)
    late_s = rules.late_s(extension, submission.received_at)
    return {"late_s": late_s, "kept_share": share, "kept_score": kept}


def _said(text: Mapping[str, str] | None, language: Language) -> str:
    return "" if text is None else text[language]


def _item(item: Mapping[str, Any], language: Language) -> RubricItemView:
    texts = {name: _said(item[name], language) for name in ("title", "message", "hint")}
    return RubricItemView.model_validate({**item, **texts})


def _run(run: Mapping[str, Any]) -> RunView:
    outcome = run["outcome"]
    status = RunStatus(outcome["status"])
    logs = outcome["logs"][:SHOWN_LOGS]
    changed = {
        "case": run["case"],
        "blame": status.blame,
        "duration_s": outcome["duration_ns"] / 1e9,
        "error": _error(outcome["error"]),
        "cleanup_error": _error(outcome["cleanup_error"]),
        "detail": visible(outcome["detail"]),
        "stdout": _stream(outcome["stdout"]),
        "stderr": _stream(outcome["stderr"]),
        "nodes": [visible(name) for name in outcome["nodes"]],
        "endpoints": [_visible_values(endpoint) for endpoint in outcome["endpoints"]],
        "logs": [_visible_values({**record, "t_s": record["t_ns"] / 1e9}) for record in logs],
        "logs_dropped": outcome["logs_dropped"] + len(outcome["logs"]) - len(logs),
        "trajectory_sha256": run["trajectory_sha256"],
    }
    return RunView.model_validate({**outcome, **changed})


def _visible_values(values: Mapping[str, Any]) -> dict[str, Any]:
    return {name: visible(value) if isinstance(value, str) else value for name, value in values.items()}


def _error(error: Mapping[str, Any] | None) -> StudentErrorView | None:
    return None if error is None else StudentErrorView.model_validate(_visible_values(error))


def _stream(stream: Mapping[str, Any]) -> StreamView:
    text = stream["text"]
    left_out = max(0, len(text) - SHOWN_CHARACTERS)
    return StreamView(text=visible(text[:SHOWN_CHARACTERS]), dropped=stream["dropped_bytes"] + left_out)
