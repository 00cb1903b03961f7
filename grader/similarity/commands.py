"""How a script drove: its commands as the simulator got them, which a changed text does not change."""

import json
from collections.abc import Iterable
from dataclasses import dataclass
from hashlib import sha256

from grader.contracts.trajectory import Command


@dataclass(frozen=True, slots=True)
class SentCommands:
    """The commands of a script in all its runs.

    Attributes:
        digest: equal for scripts that sent the same velocities at the same intervals, to the nanosecond.
        changes: how often it commanded another velocity than before. Whoever drives one straight line changes it
            twice, and drives as many others do.
    """

    digest: str
    changes: int


def drive_of(runs: Iterable[Iterable[Command]]) -> SentCommands:
    """Return the drive of a script from the commands of its runs.

    Times count from the first command of a run, so that a longer wait before it changes nothing.
    """
    digest, changes = sha256(), 0
    for run in runs:
        commands = tuple(run)
        start_ns = commands[0].t_ns if commands else 0
        before = (0.0, 0.0)
        for command in commands:
            velocity = (command.v_mps, command.w_radps)
            changes += velocity != before
            before = velocity
        sent = [(command.t_ns - start_ns, command.v_mps + 0.0, command.w_radps + 0.0) for command in commands]
        digest.update(json.dumps(sent).encode() + b"\n")
    return SentCommands(digest.hexdigest(), changes)
