"""Reports as other platforms read them."""

from collections.abc import Mapping
from datetime import datetime

from grader.contracts.report import GradeReport, GradeStatus
from grader.contracts.rubric import ItemStatus, RubricItem, summed
from grader.contracts.rules import is_hidden
from grader.contracts.text import Language
from grader.messages import quantity
from grader.render.escape import visible
from grader.render.labels import item_status_word, status_word, word

CLASSROOM50_FIELDS: Mapping[str, str] = {
    "classroom": "CLASSROOM",
    "assignment": "ASSIGNMENT",
    "submission": "SUBMISSION_TAG",
    "commit": "COMMIT_URL",
    "release": "RELEASE_URL",
    "review": "REVIEW_URL",
}
"""Of Classroom 50's ``result.json``, what its runner tells an autograder in the environment."""


def to_gradescope(
    report: GradeReport,
    language: Language = "zh",
    stored_sha256: str | None = None,
    *,
    hidden: frozenset[str] = frozenset(),
) -> dict[str, object]:
    """Return Gradescope's ``results.json`` (gradescope-autograders.readthedocs.io, "Specifications").

    `stored_sha256` is the digest of the report that was stored, where `report` has points that people gave, too.
    Rubric items that are `hidden` count, but students see neither them nor the sentences about the whole.

    While a person has still to grade, the top-level score is left out, and the score of what waits: Gradescope
    then sums what has been scored.
    """
    document: dict[str, object] = {
        "output": _overview(report, language, tells_all=not hidden),
        "output_format": "text",
        "test_output_format": "text",
        "test_name_format": "text",
        "visibility": "visible",
        "stdout_visibility": "hidden",
        "extra_data": _provenance(report, stored_sha256 or report.sha256()),
        "tests": [
            _gradescope_test(item, i, language, "hidden" if is_hidden(item.id, hidden) else "visible")
            for i, item in enumerate(report.items, start=1)
        ],
    }
    if report.score is not None:
        document["score"] = report.score
    return document


def _gradescope_test(
    item: RubricItem, position: int, language: Language, visibility: str
) -> dict[str, object]:
    scored: dict[str, object] = {
        "score": item.earned,
        "status": "passed" if item.status is ItemStatus.PASSED else "failed",
    }
    return {
        "name": visible(item.title.get(language)),
        "number": str(position),
        **({} if item.status is ItemStatus.NEEDS_MANUAL else scored),
        "max_score": item.points,
        "output": _evidence(item, language),
        "visibility": visibility,
        "extra_data": {
            "id": item.id,
            "status": item.status.value,
            "measured": item.measured,
            "target": item.target,
            "tolerance": item.tolerance,
            "unit": item.unit,
        },
    }


def to_prairielearn(
    report: GradeReport, language: Language = "zh", *, hidden: frozenset[str] = frozenset()
) -> dict[str, object]:
    """Return PrairieLearn's ``results.json`` for external grading (PrairieLearn docs/externalGrading.md).

    A file that is not Python is not gradable, which costs no attempt there. PrairieLearn shows students each test
    that is listed: rubric items that are `hidden` count, but neither they nor sentences about the whole are in it.
    """
    if report.status is GradeStatus.SYNTAX_ERROR:
        return {"gradable": False, "format_errors": [_overview(report, language)]}
    return {
        "gradable": True,
        "score": _share(report),
        "message": "" if hidden else visible(report.summary.get(language)),
        "output": _overview(report, language, tells_all=not hidden),
        "tests": [
            _prairielearn_test(item, language) for item in report.items if not is_hidden(item.id, hidden)
        ],
    }


def _prairielearn_test(item: RubricItem, language: Language) -> dict[str, object]:
    return {
        "name": visible(item.title.get(language)),
        "description": f"{word('wanted', language)}: {visible(quantity.wanted(item, language))}",
        "points": item.earned,
        "max_points": item.points,
        "message": item_status_word(item.status, language),
        "output": _evidence(item, language),
    }


def to_autolab(report: GradeReport, language: Language = "zh") -> tuple[dict[str, object], dict[str, object]]:
    """Return the last two lines of an Autolab autograder (Autolab docs/lab.md, formatted-feedback.md).

    The first is how Autolab shows the feedback, the second the points by problem. An item's id is the problem's
    name; the course's problems have to be called so. What waits for a person has no points.
    """
    stage = report.assignment
    shown: dict[str, object] = {
        "_presentation": "semantic",
        "stages": [stage],
        stage: {
            f"{number}. {visible(item.title.get(language))}": {
                "passed": item.status is ItemStatus.PASSED,
                "hint": _evidence(item, language),
            }
            for number, item in enumerate(report.items, start=1)
        },
    }
    scores = {item.id: item.earned for item in report.items if item.status is not ItemStatus.NEEDS_MANUAL}
    return shown, {"scores": scores}


def to_classroom50(
    report: GradeReport, environment: Mapping[str, str], written_at: datetime, language: Language = "zh"
) -> dict[str, object]:
    """Return Classroom 50's ``result.json`` (foundation50/classroom50, wiki/Advanced-Autograding.md).

    Points are whole there: each item's are rounded, and the score is their sum.
    """
    tests = [
        {
            "test-name": visible(item.title.get(language)),
            "passed": item.status is ItemStatus.PASSED,
            "score": round(item.earned),
            "max-score": round(item.points),
            "output": _evidence(item, language),
        }
        for item in report.items
    ]
    identity = {field: environment.get(name, "") for field, name in CLASSROOM50_FIELDS.items()}
    return {
        "schema": "classroom50/result/v1",
        **identity,
        "review": identity["review"] or identity["commit"],
        "datetime": written_at.strftime("%Y-%m-%dT%H:%M:%SZ"),
        "score": sum(round(item.earned) for item in report.items),
        "max-score": sum(round(item.points) for item in report.items),
        "tests": tests,
    }


def _share(report: GradeReport) -> float:
    """Return the score as a share in [0, 1]; items scored so far count while others wait for a person."""
    scored = summed(item.earned for item in report.items)
    score = scored if report.score is None else report.score
    return min(max(score / report.max_score, 0.0), 1.0) if report.max_score > 0 else 0.0


def _overview(report: GradeReport, language: Language, *, tells_all: bool = True) -> str:
    """Return status, summary, next step and the script's own error as plain text.

    Summary and next step are about all items; without `tells_all` they are left out.
    """
    lines = [] if report.status is GradeStatus.GRADED else [status_word(report.status, language)]
    lines += [visible(text) for text in (report.summary.get(language),) if text and tells_all]
    if (hint := report.hint.get(language)) and tells_all:
        lines.append(f"{word('next_step', language)}: {visible(hint)}")
    for run in report.runs:
        if run.outcome.error is not None:
            lines += ["", word("your_error", language), visible(run.outcome.error.traceback)]
    return "\n".join(lines)


def _evidence(item: RubricItem, language: Language) -> str:
    """Return measured, wanted, message and next step of one item as plain text."""
    lines = [
        f"{word('measured', language)}: {quantity.measured(item, language)}",
        f"{word('wanted', language)}: {quantity.wanted(item, language)}",
        item.message.get(language),
    ]
    if hint := item.hint.get(language):
        lines.append(f"{word('next_step', language)}: {hint}")
    return visible("\n".join(line for line in lines if line))


def _provenance(report: GradeReport, sha256: str) -> dict[str, object]:
    return {
        "schema_version": report.schema_version,
        "assignment": report.assignment,
        "assignment_version": report.assignment_version,
        "grader_version": report.grader_version,
        "submission_sha256": report.submission_sha256,
        "report_sha256": sha256,
        "status": report.status.value,
    }
