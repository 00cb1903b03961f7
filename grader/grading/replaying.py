"""The second half of a run with PyBullet: what the script has called is carried out again, and that is scored."""

from dataclasses import replace

from grader.contracts.assignment import Assignment, Watch
from grader.contracts.errors import InfrastructureError, ProtocolError
from grader.contracts.outcome import RunOutcome, RunStatus
from grader.contracts.replay import Replayed
from grader.jail.ending import RunEnd
from grader.sandbox import Sandbox
from grader.sim.episode import EpisodeResult
from grader.sim.recorded_calls import RecordedCalls
from grader.sim.replay import Replay, planar

_TRIES = 2
_SLOW = (RunEnd.CPU_LIMIT, RunEnd.STALLED, RunEnd.MEMORY_LIMIT)


def with_replay(result: EpisodeResult, sandbox: Sandbox, assignment: Assignment) -> EpisodeResult:
    """Return the episode with what its recorded calls came to, and the way of what the assignment looks at.

    Raises:
        InfrastructureError: the host failed.
        SandboxError: no process could be confined.
    """
    if result.recorded is None:
        return result
    replayed = _replayed(result.recorded, sandbox, assignment)
    return replace(result, replayed=replayed, trajectory=planar(replayed), sim_steps=replayed.steps)


def _replayed(recorded: RecordedCalls, sandbox: Sandbox, assignment: Assignment) -> Replayed:
    """Replay in a process of its own; one that ends before its time is tried once more."""
    watch = assignment.world.watch or Watch()
    slow = False
    for _ in range(_TRIES):
        replay = Replay(recorded, watch)
        with sandbox.open(assignment.limits) as jail:
            try:
                done = replay.run(jail)
            except ProtocolError:
                done = False
            report = jail.close()
        if done:
            return replay.account()
        if report.end is RunEnd.INFRASTRUCTURE:
            raise InfrastructureError(f"the sandbox failed in a replay: {report.detail or 'no reason given'}")
        slow = report.end in _SLOW
    return replay.account("too_slow" if slow else "crashed")


def with_replayed_end(outcome: RunOutcome, replayed: Replayed) -> RunOutcome:
    """Return the account of a run whose calls ended PyBullet itself: that is the script's crash."""
    if replayed.end not in ("crashed", "too_slow") or outcome.error is not None:
        return outcome
    status = RunStatus.CPU_LIMIT if replayed.end == "too_slow" else RunStatus.CRASHED
    return replace(outcome, status=status, detail=f"PyBullet ended within {replayed.calls} calls")
