"""What the car did in one run: the trajectory as it was recorded, as a picture, and what the checks see in it."""

import asyncio
import gzip
import io
from collections.abc import Iterator
from dataclasses import dataclass, replace

from grader.checks import sketch
from grader.contracts.assignment import Assignment
from grader.contracts.conversation import Saying
from grader.contracts.errors import AssignmentError, RefusedError, UnknownAssignmentError
from grader.contracts.figure import FigureSketch, PictureForm
from grader.contracts.identity import Caller
from grader.contracts.judgement import judged
from grader.contracts.report import CaseRun, report_from
from grader.contracts.scoring import Run
from grader.contracts.submission import StoredReport
from grader.contracts.text import Language
from grader.contracts.trajectory import decode_trajectory
from grader.use_cases.pictures import PlotSpec
from grader.use_cases.services import Services
from grader.use_cases.visibility import graded, shown_assignment

_PART_BYTES = 256 * 1024


@dataclass(frozen=True, slots=True, kw_only=True)
class Recording:
    """One run's trajectory: its JSON compressed by gzip as it is stored, and the digest of the JSON."""

    compressed: bytes
    sha256: str

    @property
    def content(self) -> bytes:
        """Return the JSON itself."""
        return gzip.decompress(self.compressed)

    def parts(self) -> Iterator[bytes]:
        """Yield the JSON in parts, so that it is never held as a whole."""
        with gzip.open(io.BytesIO(self.compressed)) as plain:
            while part := plain.read(_PART_BYTES):
                yield part


@dataclass(frozen=True, slots=True, kw_only=True)
class DrawnRun:
    """A drawn run; `tag` differs between pictures that differ."""

    content: bytes
    tag: str


@dataclass(frozen=True, slots=True, kw_only=True)
class BaggedRun:
    """A run as an MCAP file; `tag` differs between files that differ, `name` is what to save it as."""

    content: bytes
    tag: str
    name: str


def trajectory(services: Services, caller: Caller, submission_id: str, case: str | None) -> Recording:
    """Return what was recorded in the run `case` of a submission, None: in its first run.

    Raises RefusedError: the caller may not see it, there is no grading, or nothing was recorded in such a run.
    """
    _, report = graded(services, caller, submission_id)
    return _recorded(services, report, case)


async def picture(  # noqa: PLR0913, PLR0917
    services: Services,
    caller: Caller,
    submission_id: str,
    case: str | None,
    language: Language,
    form: PictureForm,
) -> DrawnRun:
    """Return the picture of one run, as the caller may see it.

    It waits on the event loop while the one thread that draws is busy: a class that looks at its pictures must not
    take the threads that uploads need.

    Raises RefusedError: as `trajectory`, or nobody knows the assignment any more.
    """
    assignment, report, recording, case_id = await asyncio.to_thread(
        _drawable, services, caller, submission_id, case
    )
    spec = PlotSpec(case=case_id, language=language, form=form)
    content = await services.plots.get(assignment, report, recording.content, spec)
    return DrawnRun(content=content, tag=f"{report.sha256}-{case_id}-{language}-{form}")


def film(services: Services, caller: Caller, submission_id: str, case: str | None) -> DrawnRun:
    """Return the pictures of one run in a PyBullet world, as one that moves.

    Raises as `picture`, or the run has none.
    """
    from grader.render.film import film as animated

    _, report, recording, case_id = _drawable(services, caller, submission_id, case)
    pictures = decode_trajectory(recording.content).pictures
    if not pictures:
        raise RefusedError("no_trajectory", field="case", allowed=[])
    return DrawnRun(content=animated(pictures), tag=f"{report.sha256}-{case_id}-film")


def bag(services: Services, caller: Caller, submission_id: str, case: str | None) -> BaggedRun:
    """Return one run as a ROS bag, with nothing in it that the caller may not see.

    Raises as `picture`, or what writes such files is not installed.
    """
    from grader.use_cases.bags import bagged

    assignment, report, recording, case_id = _drawable(services, caller, submission_id, case)
    graded_report = report_from(report.content)
    content = bagged(assignment, graded_report, report.content, recording.content, case_id)
    name = f"{graded_report.assignment}-{submission_id}-{case_id}.mcap"
    return BaggedRun(content=content, tag=f"{report.sha256}-{case_id}-mcap", name=name)


def measured_figure(
    services: Services, caller: Caller, stored: StoredReport, run: CaseRun
) -> FigureSketch | None:
    """Return the figure that the checks see in a run, judged by what the caller may see.

    None when nothing was recorded, or the assignment is no longer published in a form that can be measured.
    """
    content = services.submissions.trajectory(stored, run.case)
    if content is None:
        return None
    motion = decode_trajectory(gzip.decompress(content))
    try:
        published = services.assignments.of(caller.course).get(judged(stored).assignment)
        assignment = shown_assignment(services, caller, published)
        return sketch(assignment, Run(trajectory=motion, outcome=run.outcome, case=run.case))
    except (AssignmentError, UnknownAssignmentError):
        return None


def sayings(services: Services, stored: StoredReport, case_id: str) -> tuple[Saying, ...]:
    """Return what was said in a run, in order; nothing where nothing was recorded."""
    content = services.submissions.trajectory(stored, case_id)
    return () if content is None else decode_trajectory(gzip.decompress(content)).sayings


def _drawable(
    services: Services, caller: Caller, submission_id: str, case: str | None
) -> tuple[Assignment, StoredReport, Recording, str]:
    _, report = graded(services, caller, submission_id)
    assignment = shown_assignment(services, caller, services.submissions.graded_assignment(report))
    recording = _recorded(services, report, case)
    if report.judgements:  # the picture shows the score, which people have a part in
        whole = judged(report)
        report = replace(report, content=whole.canonical_bytes(), sha256=whole.sha256())
    return assignment, report, recording, _case_id(report, case)


def _recorded(services: Services, report: StoredReport, case: str | None) -> Recording:
    case_id = _case_id(report, case)
    compressed = services.submissions.trajectory(report, case_id)
    if compressed is None:
        raise RefusedError("no_trajectory", field="case", allowed=list(report.cases))
    return Recording(compressed=compressed, sha256=report.cases[case_id])


def _case_id(report: StoredReport, case: str | None) -> str:
    return case if case is not None else next(iter(report.cases), "")
