"""A submission as the service keeps it: its way through the queue and where its grading stands.

Three counts that must not be mixed up: a student's *attempts* are their submissions to one assignment;
`Claim.attempt` numbers the claims of one submission and fences late workers off; `tries` counts the claims
since the submission was last queued and bounds the retries.
"""

from dataclasses import dataclass
from datetime import datetime

from grader.contracts.assignment import Distro, RunsAs
from grader.contracts.python import StrEnum
from grader.contracts.report import GradeStatus


class SubmissionState(StrEnum):
    """Where a submission is on its way. The last two are ends; a re-grade starts again at ``queued``."""

    QUEUED = "queued"
    RUNNING = "running"
    GRADED = "graded"
    INFRASTRUCTURE_ERROR = "infrastructure_error"  # every try failed through no fault of the student


@dataclass(frozen=True, slots=True, kw_only=True)
class RefusedUpload:
    """An upload of a student that was not accepted.

    Attributes:
        code: of the refusal. line: of the file, where it is about one.
    """

    person: str
    assignment: str
    at: datetime
    code: str
    file_name: str
    line: int | None


@dataclass(frozen=True, slots=True, kw_only=True)
class NewSubmission:
    """An accepted upload.

    Attributes:
        source: kept byte for byte.
        course: None while there are no courses.
        key: under which the client sends the same upload again if it got no answer.
        assignment_version: the published version; when given, the same bytes again are recognised.
        distro, runs_as: what the assignment says of them; None: as in the course.
        ruled: whether the rules of the assignment decide; they do not for a course's staff.
        by: who hands it in for the student; None: the student.
        own: the assignment is one of the course's own, which somebody may remove meanwhile.
    """

    student: str
    assignment: str
    file_name: str
    source: bytes
    course: str | None = None
    key: str | None = None
    assignment_version: int | None = None
    distro: Distro | None = None
    runs_as: RunsAs | None = None
    ruled: bool = False
    by: str | None = None
    own: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class SubmissionFilter:
    """Which submissions of a class are listed; None: whatever it is.

    Attributes:
        since: received then or later. after: stored after the submission of this id.
    """

    student: str | None = None
    assignment: str | None = None
    state: SubmissionState | None = None
    since: datetime | None = None
    after: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Submission:
    """One upload and its state. Instants are aware UTC datetimes.

    Attributes:
        sha256: hexadecimal digest of the uploaded bytes.
        queued_at: instant of the last (re-)queueing. started_at: of the last claim.
        attempt: claims so far. tries: claims since it was last queued afresh.
        trouble: why the last try failed on the grader's side, empty if none did.
        verdict, score, max_score, report_sha256: of the latest grading, None before the first; verdict and
            score with what people judged.
        graded_attempt: claim number under which that grading was made.
        to_judge: rubric items that still wait for a person; None when none is a person's to judge.
        team_upload: the same of all submissions that came with one upload of a team; else None.
    """

    id: str
    student: str
    assignment: str
    file_name: str
    sha256: str
    size_bytes: int
    state: SubmissionState
    received_at: datetime
    queued_at: datetime
    started_at: datetime | None
    finished_at: datetime | None
    attempt: int
    tries: int
    trouble: str
    verdict: GradeStatus | None
    score: float | None
    max_score: float | None
    report_sha256: str | None
    graded_attempt: int | None
    course: str | None = None
    to_judge: int | None = None
    team_upload: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Claim:
    """The right of one worker to grade one submission, until its lease ends.

    Attributes:
        attempt: fencing token; a result is taken only from the latest claim.
        queued_at: instant of the last (re-)queueing.
        course: None without one. distro, runs_as: its settings.
    """

    submission_id: str
    attempt: int
    tries: int
    worker: str
    assignment: str
    file_name: str
    source: bytes
    queued_at: datetime
    course: str | None
    distro: Distro | None
    runs_as: RunsAs | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Judgement:
    """What somebody gave for one rubric item of one submission. A later one takes its place; all are kept.

    Attributes:
        revision: 1 for the first judgement of the item, then 2, ...
        points: 0 <= points <= out_of, rounded to 1e-2.
        out_of: most the item could earn then; 0 takes back what was decided about what a machine judges, so that
            the machine's points count again.
        comment: for the student; may be empty for what no machine judges.
        attempt: number of the grading that was looked at. source_sha256: digest of the answer.
    """

    submission: str
    item: str
    revision: int
    points: float
    out_of: float
    comment: str
    by: str
    at: datetime
    attempt: int
    source_sha256: str


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredReport:
    """A grading as it was stored.

    Attributes:
        content: canonical bytes of the report; `sha256` is their digest.
        assignment_sha256: digest of the assignment as it was graded.
        cases: case id to the digest of its trajectory, in the order of the report.
        judgements: everything that people decided about the submission, in order of item and revision.
    """

    submission_id: str
    attempt: int
    finished_at: datetime
    content: bytes
    sha256: str
    cases: dict[str, str]
    assignment_sha256: str
    judgements: tuple[Judgement, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class QueueState:
    """How much is waiting. `oldest_queued_at` is None when nothing waits."""

    queued: int
    running: int
    infrastructure_errors: int
    oldest_queued_at: datetime | None


@dataclass(frozen=True, slots=True, kw_only=True)
class PersonCost:
    """What one student's gradings cost the service lately.

    Attributes:
        student: empty for the gradings of a re-grading, which are nobody's.
        slot_s: for how long they held a slot. gradings: how many ended or run. waiting: how many wait.
        tries: how often they were begun. given_up: how many ended as ``infrastructure_error``.
    """

    course: str | None
    student: str
    slot_s: float
    gradings: int
    waiting: int
    tries: int
    given_up: int


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkerState:
    """What a worker process last said about itself."""

    id: str
    slots: int
    busy: int
    sandbox_ready: bool
    isolation: str
    detail: str
    started_at: datetime
    seen_at: datetime
