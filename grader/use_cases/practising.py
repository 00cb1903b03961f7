"""Practice: running a script of an assignment for its author's eyes. It costs no attempt, and nothing is kept.

The answer shows less than a graded submission would show the caller: there are no points, only the first of the
assignment's cases is run, and where the world has noise it is not the noise that counts.
"""

import asyncio
from collections.abc import AsyncIterator
from concurrent.futures import Future
from contextlib import ExitStack, asynccontextmanager, suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from grader.checks import sketch
from grader.contracts.assignment import SUFFIXES, Assignment
from grader.contracts.errors import RefusedError, SandboxUnavailableError
from grader.contracts.figure import FigureSketch
from grader.contracts.grading import GradingJob, GradingResult, RunProgress
from grader.contracts.identity import Caller, Role
from grader.contracts.report import CaseOutput, GradeReport
from grader.contracts.scoring import Run
from grader.contracts.trajectory import decode_trajectory
from grader.contracts.upload import check_name, check_source, same_program
from grader.grading.practice import PracticeRun
from grader.operation.logs import note
from grader.use_cases.assignments import visible_assignment
from grader.use_cases.callers import name_of
from grader.use_cases.handing_in import shown_name
from grader.use_cases.services import Services
from grader.use_cases.visibility import shown_report

_CPU_S = 10.0
_WALL_S = 15.0
_OUTPUT_BYTES = 256 * 1024
_OTHER_NOISE = 1_000_003
_USUAL_S = 1.0  # a run that takes longer counts as several
_GLANCE_S = 0.2


@dataclass(frozen=True, slots=True, kw_only=True)
class Practice:
    """What a practice run showed.

    Attributes:
        assignment: as it was run, without the items that the caller does not see.
        report: without these items; its points mean nothing.
        trajectory: JSON of where the car was; None when nothing was recorded.
        figure: what the checks saw in that; None when they cannot say.
        cases: how many the assignment has; one of them was run.
        untouched: it was the assignment's starter as it was given.
        cut_output: what a script had printed that was ended for printing too much.
    """

    assignment: Assignment
    report: GradeReport
    trajectory: bytes | None
    figure: FigureSketch | None
    cases: int
    cut_output: tuple[CaseOutput, ...]
    untouched: bool


def practisable(services: Services, caller: Caller, assignment_id: str) -> Assignment:
    """Return an assignment that the caller may practise, without the items that they do not see.

    Raises:
        RefusedError: the caller is no member of a course, the assignment is not there for them or not open yet, or
            is none that a single script answers.
    """
    if caller.person is None or caller.course is None:
        raise RefusedError("no_course")
    assignment = visible_assignment(services, caller, assignment_id)
    if not _is_open(services, caller, assignment_id):
        raise RefusedError("assignment_not_found")
    if assignment.input != "script":
        raise RefusedError("practice_scripts_only")
    return assignment


def may_practise(services: Services, caller: Caller, assignment: Assignment) -> bool:
    """Return whether the caller, who sees `assignment`, may practise it now."""
    is_member = caller.person is not None and caller.course is not None
    return is_member and assignment.input == "script" and _is_open(services, caller, assignment.id)


def _is_open(services: Services, caller: Caller, assignment_id: str) -> bool:
    if caller.role is not Role.STUDENT:
        return True
    opens = services.rules.of(caller.course).of(assignment_id, caller.person).opens
    return opens is None or services.clock() >= opens


class UnderWay:
    """A practice run that somebody waits for, in the event loop that began it."""

    def __init__(self, services: Services, caller: Caller, job: GradingJob, run: PracticeRun) -> None:
        self._services = services
        self._caller = caller
        self._job = job
        self._run = run
        self._ended = asyncio.Event()
        # not asyncio.wrap_future: result and future would hold each other until somebody collects garbage
        run.answer.add_done_callback(partial(_wake, asyncio.get_running_loop(), self._ended))

    async def where(self) -> AsyncIterator[RunProgress | int]:
        """Yield how many have to end before the run begins, then how far it is, as that changes, until it ends."""
        last: RunProgress | int | None = None
        while not self._ended.is_set():
            now = self._services.practice.where(self._run)
            if now != last:
                last = now
                yield now
            with suppress(TimeoutError):
                await asyncio.wait_for(self._ended.wait(), _GLANCE_S)

    async def result(self) -> Practice:
        """Wait for the end of the run and return what it showed.

        Raises:
            RefusedError: submissions wait; practice is not offered.
            InfrastructureError: a fault of the grader or its host.
        """
        await self._ended.wait()
        try:
            result = self._run.answer.result()
        except SandboxUnavailableError as error:
            raise RefusedError("practice_off") from error
        note(assignment=self._job.assignment.id, code="practised")
        return await asyncio.to_thread(_shown_practice, self._services, self._caller, self._job, result)


def _wake(loop: asyncio.AbstractEventLoop, ended: asyncio.Event, _: object) -> None:
    with suppress(RuntimeError):  # the loop is closed: nobody waits any more
        loop.call_soon_threadsafe(ended.set)


@asynccontextmanager
async def practising(
    services: Services, caller: Caller, assignment_id: str, file_name: str, source: bytes
) -> AsyncIterator[UnderWay]:
    """Run a script once for practice, behind all submissions; leaving the context gives the run up.

    The caller has no other run until this one has ended.

    Raises:
        RefusedError: as `practisable`; it is no script; the caller has one under way or asks too often;
            others' runs wait; practice is not offered.
    """
    owner = name_of(caller) or ""
    with ExitStack() as stack:
        stack.enter_context(services.allowances.practice_at_once.one_more(owner))
        job = await asyncio.to_thread(_job, services, caller, assignment_id, file_name, source)
        services.allowances.practice.take(owner)
        run = services.practice.run(job)
        counted = stack.pop_all()

    def ended(answer: "Future[Any]") -> None:
        if not answer.cancelled() and answer.exception() is None:
            wall_s = answer.result().measurements.wall_s
            services.allowances.practice.charge(owner, wall_s // _USUAL_S)
        counted.close()

    run.answer.add_done_callback(ended)  # also of a run that nobody waits for any more
    try:
        yield UnderWay(services, caller, job, run)
    finally:
        run.answer.cancel()  # unless it has begun


def for_practice(assignment: Assignment) -> Assignment:
    """Return an assignment as it is practised: its first case alone, other noise, and tighter limits."""
    first, world, limits = assignment.cases[0], assignment.world, assignment.limits
    seed = world.seed if first.seed is None else first.seed
    return replace(
        assignment,
        cases=(replace(first, seed=seed + _OTHER_NOISE),),
        limits=replace(
            limits,
            cpu_s=min(limits.cpu_s, _CPU_S),
            wall_s=min(limits.wall_s, _WALL_S),
            output_bytes=min(limits.output_bytes, _OUTPUT_BYTES),
        ),
    )


def _job(services: Services, caller: Caller, assignment_id: str, file_name: str, source: bytes) -> GradingJob:
    practisable(services, caller, assignment_id)
    name = shown_name(file_name)
    check_name(name, SUFFIXES["script"])
    check_source(source, services.settings.max_upload_bytes)
    # whole: an item that is shown may need one that is not, and what is not shown is left out of the report
    assignments = services.assignments.of(caller.course).get(assignment_id)
    course = services.rules.of(caller.course)
    as_graded = assignments.of_course(course.distro, course.runs_as)
    return GradingJob(file_name=name, source=source, assignment=for_practice(as_graded))


def _shown_practice(services: Services, caller: Caller, job: GradingJob, result: GradingResult) -> Practice:
    ran: Assignment = job.assignment
    starter = services.assignments.of(caller.course).starter(ran.id)
    report = shown_report(services, caller, result.report)
    task = practisable(services, caller, ran.id)
    visible = {item.id for item in task.items}
    shown = replace(ran, items=tuple(item for item in ran.items if item.id in visible))
    case = ran.cases[0].id
    content = result.trajectories.get(case)
    figure = None
    if content is not None and report.runs:
        motion = decode_trajectory(content)
        figure = sketch(shown, Run(trajectory=motion, outcome=report.runs[0].outcome, case=case))
    cut = result.measurements.cut_output
    return Practice(
        assignment=shown,
        report=report,
        trajectory=content,
        figure=figure,
        cases=len(task.cases),
        cut_output=cut,
        untouched=bool(starter) and same_program(job.source, starter),
    )
