"""The grading process: holds the physics, the sandbox's zygote and the checks; grades what its parent sends.

`launch` starts it. Its parent, a `slot.Slot`, then sends its configuration and the jobs over one pipe. Importing
PyBullet takes most of a cold start, so the zygote is started before that and warms up on the other core.
"""

import gc
import os
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import Any

from grader.contracts.assignment import Limits
from grader.contracts.errors import GraderError, NoRoomError, SandboxUnavailableError, lacks_room
from grader.contracts.extras import MissingExtraError
from grader.contracts.grading import GradingJob, RunProgress
from grader.grading.slot import NO_ROOM_CODE, Channel, SlotConfig, job_from_message, result_message
from grader.jail.supervisor import yield_session
from grader.sandbox import Sandbox, script_sandbox


def main(arguments: list[str]) -> int:
    """Serve the parent on the inherited descriptors `arguments` (requests, answers) until it closes."""
    try:
        return _main(arguments)
    except (MemoryError, OSError, RuntimeError) as error:
        if not lacks_room(error):
            raise
        return NO_ROOM_CODE


def _main(arguments: list[str]) -> int:
    channel = Channel(*map(int, arguments))
    configuration = channel.receive()
    if configuration is None:
        return 0
    config = SlotConfig(**configuration)
    if config.niceness:
        _give_way(config.niceness)  # before the zygote is started, which takes after this process
    try:
        sandbox = script_sandbox(config.mode)
    except GraderError as error:
        return _refuse(channel, error)
    with sandbox, suppress(BrokenPipeError):  # the parent is gone
        _serve(channel, sandbox)
    return 0


def _give_way(niceness: int) -> None:
    """Lower the priority of this process and of whatever it will start.

    Besides being nice, it joins the batch class, whose processes do not interrupt others when they wake up
    (sched(7)).
    """
    try:
        os.setpriority(os.PRIO_PROCESS, 0, niceness)
        if sys.platform == "linux":
            os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
    except OSError:
        return  # a container may forbid even that
    yield_session(os.getpid(), niceness)


def _serve(channel: Channel, sandbox: Sandbox) -> None:
    """Grade what the parent sends. The sandbox proves itself while the physics is imported."""
    proof = threading.Thread(target=_prepare, args=(sandbox, Limits()))
    proof.start()
    from grader.grading.pipeline import Pipeline

    with Pipeline(sandbox) as pipeline:
        proof.join()
        gc.freeze()  # nothing that was imported is garbage
        is_first = True
        while (request := channel.receive()) is not None:
            job = job_from_message(request)
            on_progress = partial(_send_progress, channel) if request.get("tells") else None
            if request.get("kind") == "explain":
                channel.send(
                    _explanation(pipeline, job, frozenset(request["hidden"]), partial(_ask, channel))
                )
            else:
                channel.send(*_answer(pipeline, job, lambda: channel.send({"kind": "running"}), on_progress))
            # Nobody waits now, so do here what would cost time while somebody does. Automatic collection is off
            # (`launch`).
            with suppress(GraderError):  # the next grading meets the fault again, and can report it
                pipeline.prepare(job.assignment)
            gc.collect()
            if is_first:
                gc.freeze()  # nor what the first grading has left: more modules, and caches
                is_first = False


def _prepare(sandbox: Sandbox, limits: Limits) -> None:
    """Get ready to run a script under `limits`; a fault is met again by the first grading, which can report it."""
    with suppress(GraderError):
        sandbox.prepare(limits)


def _send_progress(channel: Channel, progress: RunProgress) -> None:
    channel.send({"kind": "progress", "progress": progress})


def _answer(
    pipeline: Any,
    job: GradingJob,
    on_run: Callable[[], None],
    on_progress: Callable[[RunProgress], None] | None,
) -> tuple[dict[str, Any], list[bytes]]:
    try:
        return result_message(pipeline.grade(job, on_run, on_progress))
    except GraderError as error:
        return _fault(error), []


def _explanation(
    pipeline: Any, job: GradingJob, hidden: frozenset[str], before_each: Callable[[], None]
) -> dict[str, Any]:
    try:
        return {"kind": "explanation", "explanation": pipeline.explain(job, hidden, before_each)}
    except GraderError as error:
        return _fault(error)


def _ask(channel: Channel) -> None:
    """Ask the parent whether to grade the next change; it answers when nobody else waits."""
    channel.send({"kind": "trial"})
    if channel.receive() is None:
        raise BrokenPipeError  # the parent is gone, or has given the search up


def _refuse(channel: Channel, error: GraderError) -> int:
    """Answer every request with why this process cannot grade."""
    while channel.receive() is not None:
        channel.send(_fault(error))
    return 2


def _fault(error: GraderError) -> dict[str, Any]:
    if isinstance(error, MissingExtraError):
        return {"kind": "missing_extra", "message": error.extra}
    kinds: dict[type[GraderError], str] = {SandboxUnavailableError: "unavailable", NoRoomError: "no_room"}
    return {"kind": kinds.get(type(error), "fault"), "message": str(error)}
