"""From a submission to a graded report: run every case, score the motion, put the report together."""

import hashlib
import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from grader import __version__
from grader.contracts.assignment import Assignment, Case, InterfaceDefinition, World, WorldKind
from grader.contracts.errors import AssignmentError, GraderError
from grader.contracts.explanation import Explanation
from grader.contracts.extras import MissingExtraError
from grader.contracts.grading import GradingJob, GradingResult, RunProgress
from grader.contracts.outcome import Note, RunOutcome, StudentError
from grader.contracts.package import MODULES, PackageProblem
from grader.contracts.python import Self
from grader.contracts.record import Record, field
from grader.contracts.report import (
    CaseOutput,
    CaseRun,
    GradeReport,
    GradeStatus,
    Measurements,
    status_of,
)
from grader.contracts.rubric import ItemStatus, summed
from grader.contracts.rules import is_hidden
from grader.contracts.scoring import Run, Scoring
from grader.contracts.trajectory import encode_trajectory, recorded
from grader.contracts.upload import decoded
from grader.grading.budget import outputs_within_budget, within_budget
from grader.grading.outcome import ended_by_the_clock, is_repeatable, masked_stream, merge
from grader.sandbox import JailReport, Sandbox, pybullet_sandbox
from grader.sim.driving import CAR_MODEL, Car
from grader.sim.episode import WAIT_NOTE, Episode, EpisodeResult, EpisodeSpec
from grader.sim.frames import INTERRUPTED_NOTE, THREADS_NOTE, Link
from grader.sim.robot import ROBOT_MODEL

if TYPE_CHECKING:
    from grader.checks import Marks
    from grader.grading.trial import Graded
    from grader.sim.robot_body import RobotBody

REPLAY_MODEL: Final = 1  # raised whenever the same calls may give another account
UNREAD_NOTE = "setup_unread"
"""Names what of a setup.py only running it would tell."""

_MODELS: Final[Mapping[WorldKind, str]] = {
    "turtle": f"turtle-car {CAR_MODEL}",
    "robot": f"robot {ROBOT_MODEL}",
    "pybullet": f"replay {REPLAY_MODEL}",
}

Account: TypeAlias = tuple[EpisodeResult, JailReport]
"""What the simulator and what the sandbox saw of one run."""

OnProgress: TypeAlias = Callable[[RunProgress], None]


class _Script(Record):
    """What of a submission is run.

    Attributes:
        source: the text of the script, or of the module that a package's executable is in.
        body: what START ends with. fields: START's ``package``; None for a script.
        problems: what is wrong with a package's files. unread: what of its setup.py could not be read.
        texts: of a package's modules, by path.
        interfaces: that it defines.
    """

    file_name: str
    source: str
    body: bytes
    fields: Mapping[str, Any] | None = None
    problems: tuple[PackageProblem, ...] | None = None
    unread: str = ""
    texts: Mapping[str, str] = field(default_factory=dict)
    interfaces: tuple[InterfaceDefinition, ...] = ()

    def concerned(self, error: StudentError | None) -> str:
        """Return the text of the file that an error is in; without one, that of what was run."""
        return self.source if error is None else self.texts.get(error.file, self.source)


def _own_interfaces(
    texts: Mapping[str, str],
) -> tuple[tuple[InterfaceDefinition, ...], tuple[PackageProblem, ...]]:
    """Return the interfaces that a package defines, or what is wrong with them."""
    if not texts:
        return (), ()
    from grader.catalog.interfaces import own_interfaces

    try:
        return own_interfaces(texts), ()
    except AssignmentError as error:
        place, told = error.problems[0]
        return (), (PackageProblem("package_interface", MODULES, True, {"place": place, "problem": told}),)


def _script_of(job: GradingJob) -> _Script:
    if job.assignment.input != "package":
        return _Script(file_name=job.file_name, source=decoded(job.source), body=job.source)
    from grader.formats.packages.mounting import mounted

    package = mounted(job.source, job.assignment.package, job.assignment.release)
    allowed = job.assignment.package is not None and job.assignment.package.interfaces
    interfaces, wrong = _own_interfaces(package.interfaces if allowed else {})
    return _Script(
        file_name=package.file_name,
        source=package.source,
        body=package.body,
        fields=package.fields,
        problems=(*wrong, *package.problems),
        interfaces=interfaces,
        unread=package.unread,
        texts=package.texts,
    )


class Pipeline:
    """Grades submissions one after the other in one process; owns the simulated car, not the sandbox."""

    def __init__(self, sandbox: Sandbox) -> None:
        self._sandbox = sandbox
        self._car = Car()
        self._body: RobotBody | None = None
        self._with_pybullet: Sandbox | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._car.close()
        if self._body is not None:
            self._body.close()
        if self._with_pybullet is not None:
            self._with_pybullet.close()

    def prepare(self, assignment: Assignment) -> None:
        """Get ready to run another script of the same assignment. Raises as `Sandbox.prepare`."""
        self._sandbox_for(assignment).prepare(assignment.limits)

    def _sandbox_for(self, assignment: Assignment) -> Sandbox:
        """Return where scripts of an assignment run. PyBullet's own is started for the first that needs it."""
        if assignment.world.kind != "pybullet":
            return self._sandbox
        if self._with_pybullet is None:
            self._with_pybullet = pybullet_sandbox(self._sandbox.mode)
        return self._with_pybullet

    def grade(
        self,
        job: GradingJob,
        on_run: Callable[[], None] = lambda: None,
        on_progress: OnProgress | None = None,
    ) -> GradingResult:
        """Run and score one submission; a text is only read.

        `on_run` is called when a run has begun, `on_progress` now and then while it lasts.

        Raises:
            InfrastructureError, SandboxError: a fault of the grader or its host; nothing was scored.
            MissingExtraError, AssignmentError: its world needs PyBullet; it does not fit its check.
        """
        if job.assignment.input == "text":
            return self._read(job)
        _simulator(job.assignment.world)  # before anything runs
        from grader.checks import mark, unmet

        script = _script_of(job)
        cases = job.assignment.cases
        accounts = [self._run_repeatably(job, script, case, on_run, on_progress) for case in cases]
        runs = [
            _scored_run(case, job.assignment, script, *account)
            for case, account in zip(cases, accounts, strict=True)
        ]
        trajectories = {run.case: encode_trajectory(run.trajectory) for run in runs}
        marks = mark(job.assignment, runs)
        report = _report(
            job, _with_notes_of_both(runs, marks), _explained(job.assignment, marks), trajectories
        )
        return GradingResult(
            report=report,
            trajectories=trajectories,
            measurements=replace(
                self._measurements(accounts), cut_output=_cut_outputs(job.assignment, accounts)
            ),
            requests={case.id: episode.requests for case, (episode, _) in zip(cases, accounts, strict=True)},
            unmet=unmet(job.assignment, marks),
        )

    def explain(
        self,
        job: GradingJob,
        hidden: frozenset[str] = frozenset(),
        before_each: Callable[[], None] = lambda: None,
    ) -> Explanation:
        """Look for changes of a script that gain marks; its report is as if nobody had looked.

        `hidden`: items that are left out as if there were none. `before_each` is called before each grading.

        Raises:
            InfrastructureError, SandboxError: as `grade`.
        """
        from grader.grading.trial import Graded, Search

        if job.assignment.input != "script" or job.assignment.world.kind == "pybullet":
            return Explanation()

        def grade(text: str, assignment: Assignment, traced: bool) -> Graded:
            before_each()
            source = text.encode("utf-8", "replace")
            return self._graded(replace(job, source=source, assignment=assignment), hidden, traced=traced)

        search = Search(job.assignment, grade)
        try:
            return search.explanation(decoded(job.source))
        except (GraderError, BrokenPipeError):
            raise
        except Exception:  # it reads the script's tree and what its process says of itself
            logging.getLogger(__name__).exception("%s: no explanation of the marks", job.assignment.id)
            return Explanation()

    def _graded(self, job: GradingJob, hidden: frozenset[str], *, traced: bool) -> "Graded":
        """Grade a text for `Search`."""
        from grader.checks import mark
        from grader.grading.trial import Graded, run_work_s

        assignment, script = job.assignment, _script_of(job)
        accounts = [
            self._run(assignment, replace(_episode_spec(job, script, case), facts=traced))
            for case in assignment.cases
        ]
        runs = [
            _scored_run(case, assignment, script, *account)
            for case, account in zip(assignment.cases, accounts, strict=True)
        ]
        items = tuple(
            item for item in mark(assignment, runs).items(assignment) if not is_hidden(item.id, hidden)
        )
        lacking = (item.id.rpartition("/")[0] for item in items if item.status is ItemStatus.FAILED)
        case_id = next(lacking, "")
        place = next((i for i, run in enumerate(runs) if run.case == case_id), 0)
        first, _ = accounts[place]
        return Graded(
            items=items,
            outcome=runs[place].outcome,
            case=runs[place].case,
            work_s=sum(
                run_work_s(episode.command_count, episode.sim_steps, run.outcome.status)
                for (episode, _), run in zip(accounts, runs, strict=True)
            ),
            tree=first.tree,
            ledger=first.ledger,
        )

    def _read(self, job: GradingJob) -> GradingResult:
        """Score a text."""
        from grader.checks import evaluate_text

        scoring = evaluate_text(job.assignment, decoded(job.source))
        return GradingResult(
            report=_report(job, [], scoring, {}), trajectories={}, measurements=self._measurements([])
        )

    def _run_repeatably(
        self,
        job: GradingJob,
        script: "_Script",
        case: Case,
        on_run: Callable[[], None],
        on_progress: OnProgress | None,
    ) -> Account:
        """Run one case; one that only a clock ended is run once more, when the host may be less busy.

        Not one that had sent and printed nothing for the second half of its CPU time: it hangs on any host.
        """
        spec = _episode_spec(job, script, case)
        episode, jail = self._run(job.assignment, spec, on_run, on_progress)
        if ended_by_the_clock(episode, jail) and not jail.settled:
            return self._run(job.assignment, spec, on_run, on_progress)
        return episode, jail

    def _run(
        self,
        assignment: Assignment,
        spec: EpisodeSpec,
        on_run: Callable[[], None] = lambda: None,
        on_progress: OnProgress | None = None,
    ) -> Account:
        def meanwhile() -> None:
            on_run()
            from grader.checks import problems

            problems(assignment)  # imports the check: the first run of a process has the time for it now

        limits = assignment.limits
        episode = Episode(spec, self._car, self._robot)
        with self._sandbox_for(assignment).open(limits) as jail:

            def on_note(code: str) -> None:
                if code == INTERRUPTED_NOTE:  # a script that got Ctrl+C has only its grace left
                    jail.limit_cpu(limits.grace_cpu_s)
                elif code == THREADS_NOTE:
                    jail.gather_threads()

            link: Link = jail
            if on_progress is not None:
                from grader.grading.progress import ProgressLink

                link = ProgressLink(jail, episode, on_progress, assignment.release)
            result, report = episode.run(link, meanwhile, on_note, jail.take_turns), jail.close()
        if result.recorded is not None:
            from grader.grading.replaying import with_replay

            result = with_replay(result, self._sandbox_for(assignment), assignment)
        return result, report

    def _robot(self) -> "RobotBody":
        """Return the robot's body, which most gradings do not need."""
        from grader.sim.robot_body import RobotBody

        if self._body is None:
            self._body = RobotBody()
        return self._body

    def _measurements(self, accounts: list[Account]) -> Measurements:
        return Measurements(
            wall_s=sum(jail.wall_ns for _, jail in accounts) / 1e9,
            jail_cpu_s=sum(jail.cpu_ns for _, jail in accounts) / 1e9,
            jail_peak_bytes=max((jail.peak_bytes for _, jail in accounts), default=0),
            sim_steps=sum(episode.sim_steps for episode, _ in accounts),
            isolation=self._sandbox.isolation,
            missing_layers=tuple(self._sandbox.missing_layers),
        )


def _cut_outputs(assignment: Assignment, accounts: Sequence[Account]) -> tuple[CaseOutput, ...]:
    """Return what scripts had printed that a clock ended."""
    return outputs_within_budget(
        _cut_output(case, jail, assignment)
        for case, (episode, jail) in zip(assignment.cases, accounts, strict=True)
        if not is_repeatable(episode, jail)
    )


def _cut_output(case: Case, jail: JailReport, assignment: Assignment) -> CaseOutput:
    distro = assignment.release
    return CaseOutput(
        case=case.id,
        stdout=masked_stream(jail.stdout, distro),
        stderr=masked_stream(jail.stderr, distro),
    )


def _scored_run(
    case: Case, assignment: Assignment, script: _Script, episode: EpisodeResult, jail: JailReport
) -> Run:
    outcome = _within_file(merge(episode, jail, assignment.release), script)
    if episode.replayed is not None:
        from grader.grading.replaying import with_replayed_end

        outcome = with_replayed_end(outcome, episode.replayed)
    if script.unread:
        outcome = replace(outcome, notes=(Note(code=UNREAD_NOTE, text=script.unread), *outcome.notes))
    return Run(
        case=case.id,
        trajectory=recorded(episode.trajectory),
        outcome=outcome,
        conversation=episode.conversation,
        source=script.concerned(outcome.error),
        package=script.problems,
        at_horizon=next((note.text for note in episode.notes if note.code == INTERRUPTED_NOTE), ""),
        replayed=episode.replayed,
    )


def _within_file(outcome: RunOutcome, script: _Script) -> RunOutcome:
    """Return the outcome; its error has no line if its file has no such line, as where `exec` ran other code."""
    error = outcome.error
    if error is None or error.line is None or 0 < error.line <= script.concerned(error).count("\n") + 1:
        return outcome
    return replace(outcome, error=replace(error, line=None))


def _with_notes_of_both(runs: Sequence[Run], marks: "Marks") -> list[Run]:
    """Return the runs, with notes on both motions where one tells that commands waited for long."""
    from grader.checks.remarks import notes_of_both

    remaining = list(runs)
    for i, run in enumerate(runs):
        if any(note.code == WAIT_NOTE for note in run.outcome.notes):
            notes = notes_of_both(run, as_commanded=marks.as_commanded)
            remaining[i] = replace(run, outcome=replace(run.outcome, notes=(*run.outcome.notes, *notes)))
    return remaining


def _explained(assignment: Assignment, marks: "Marks") -> Scoring:
    """Return the marks with their explanation; without one if looking for it fails."""
    from grader.checks import explained, unexplained

    try:
        return explained(assignment, marks)
    except Exception:  # it reads the script and what its process says of itself
        logging.getLogger(__name__).exception("%s: no explanation of the marks", assignment.id)
        return unexplained(assignment, marks)


def _episode_spec(job: GradingJob, script: _Script, case: Case) -> EpisodeSpec:
    return EpisodeSpec(
        world=job.assignment.in_case(case.id).world,
        horizon_ns=round(job.assignment.horizon_s * 1_000_000_000),
        source=script.body,
        file_name=script.file_name,
        package=script.fields,
        args=case.args,
        stdin=case.stdin,
        said=job.assignment.steps,
        expectations=job.assignment.expectations,
        interfaces=(*job.assignment.interfaces, *script.interfaces),
        output_bytes=job.assignment.limits.output_bytes,
        steps=job.assignment.limits.steps,
        distro=job.assignment.release,
        runs_as=job.assignment.started_as,
    )


def _simulator(world: World) -> str:
    """Return what computed a run's motion, with PyBullet's version where its numbers are scored.

    Raises MissingExtraError: that needs PyBullet, which is not installed.
    """
    if world.kind == "turtle" and world.profile == "nominal":
        return _MODELS["turtle"]
    try:
        from grader.sim.bullet import ENGINE, ROUNDING
    except ModuleNotFoundError as error:
        raise MissingExtraError.named("physics") from error
    # of the cars the recording's grid swallows what C libraries round otherwise; of robots, too, but for a few
    # that drive into something: four of the corpus, without another mark
    replayed = f", {ROUNDING}" if world.kind == "pybullet" else ""
    return f"{_MODELS[world.kind]}, {ENGINE}{replayed}"


def _report(
    job: GradingJob, runs: list[Run], scoring: Scoring, trajectories: dict[str, bytes]
) -> GradeReport:
    assignment: Assignment = job.assignment
    status = status_of(scoring.items, [run.outcome for run in runs])
    outcomes = within_budget(run.outcome for run in runs)  # scored as a whole, shown in part
    score = summed(item.earned for item in scoring.items)
    return GradeReport(
        submission_sha256=hashlib.sha256(job.source).hexdigest(),
        assignment=assignment.id,
        assignment_version=assignment.version,
        grader_version=__version__,
        simulator=_simulator(assignment.world),
        seed=assignment.world.seed,
        status=status,
        score=None if status is GradeStatus.NEEDS_MANUAL else score,
        max_score=assignment.max_score,
        items=scoring.items,
        runs=tuple(
            CaseRun(
                case=run.case,
                outcome=outcome,
                trajectory_sha256=hashlib.sha256(trajectories[run.case]).hexdigest(),
            )
            for run, outcome in zip(runs, outcomes, strict=True)
        ),
        summary=scoring.summary,
        interface=f"ros2-{assignment.release}",
        hint=scoring.hint,
        mistakes=scoring.mistakes,
    )
