"""The grading process: holds the physics, the sandbox's zygote and the checks; grades what its parent sends.

Started by `grader.slot.Slot`. Importing PyBullet takes most of a cold start, so the zygote is started first and
warms up on the other core meanwhile.
"""

from __future__ import annotations

import json
import os
import socket
import sys

from grader.bootstrap import build_sandbox
from grader.contracts.errors import GraderError, SandboxUnavailableError
from grader.slot import SlotConfig, job_from_message, receive_message, result_message, send_message


def main(arguments: list[str]) -> int:
    """Serve the parent on the inherited socket `arguments[0]` until it closes."""
    channel = socket.socket(fileno=int(arguments[0]))
    config = SlotConfig(**json.loads(arguments[1]))
    os.nice(config.niceness)
    try:
        sandbox = build_sandbox(config)
    except GraderError as error:
        return _refuse(channel, error)
    from grader.pipeline import Pipeline

    with sandbox, Pipeline(sandbox) as pipeline:
        while (request := receive_message(channel)) is not None:
            try:
                answer = result_message(pipeline.grade(job_from_message(request)))
            except GraderError as error:
                answer = _fault(error)
            send_message(channel, answer)
    return 0


def _refuse(channel: socket.socket, error: GraderError) -> int:
    """Answer every request with why this process cannot grade."""
    while receive_message(channel) is not None:
        send_message(channel, _fault(error))
    return 2


def _fault(error: GraderError) -> dict[str, str]:
    kind = "unavailable" if isinstance(error, SandboxUnavailableError) else "fault"
    return {"kind": kind, "message": str(error)}


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
