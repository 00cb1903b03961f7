"""A slot: one supervised grading process, seen from the parent.

The child (`grader.grading`) holds PyBullet, the sandbox's zygote and the checks. The parent speaks to it over
one socket in length-prefixed JSON; both ends are ours. When the child dies or does not answer in time, the job
is an `InfrastructureError`, the child is replaced, and the caller may try again.
"""

from __future__ import annotations

import base64
import json
import os
import signal
import socket
import struct
import subprocess
import sys
from dataclasses import asdict, dataclass
from types import TracebackType
from typing import Any, Self

from grader.contracts.codec import from_plain, to_plain
from grader.contracts.errors import InfrastructureError, SandboxUnavailableError
from grader.contracts.grading import GradingJob, GradingResult
from grader.contracts.report import GradeReport, Measurements

_LENGTH = struct.Struct("<I")
_SPARE_S = 30.0  # importing the physics on a loaded machine, checks, encoding
_KEPT_ENVIRONMENT = ("PATH", "HOME", "LANG", "TMPDIR", "PYTHONPATH", "VIRTUAL_ENV")


@dataclass(frozen=True, slots=True, kw_only=True)
class SlotConfig:
    """How a grading process isolates submissions.

    Attributes:
        mode: ``strict``, ``best-effort`` or ``dev`` (see docs/design.md).
        preload_numpy: whether the zygote imports numpy once, for scripts that use it.
        namespaces: whether to add namespaces when the host offers them.
        niceness: added to the process's priority number, so that a service answers while it grades.
    """

    mode: str = "strict"
    preload_numpy: bool = False
    namespaces: bool = True
    niceness: int = 0


class Slot:
    """Parent side of one grading process. Not thread-safe: one thread owns a slot."""

    def __init__(self, config: SlotConfig) -> None:
        self._config = config
        self._process: subprocess.Popen[bytes] | None = None
        self._channel: socket.socket | None = None

    def start(self) -> None:
        """Start the grading process without waiting for it to be ready; harmless when it runs."""
        if self._process is not None and self._process.poll() is None:
            return
        self.close()
        ours, theirs = socket.socketpair()
        environment = {name: os.environ[name] for name in _KEPT_ENVIRONMENT if name in os.environ}
        with theirs:
            self._process = subprocess.Popen(
                [
                    sys.executable,
                    "-m",
                    "grader.grading",
                    str(theirs.fileno()),
                    json.dumps(asdict(self._config)),
                ],
                pass_fds=(theirs.fileno(),),
                env=environment,
                stdin=subprocess.DEVNULL,
                start_new_session=True,  # Ctrl+C in a terminal is for the parent, which then drains
            )
        self._channel = ours

    def grade(self, job: GradingJob) -> GradingResult:
        """Grade `job` in the child.

        Raises:
            InfrastructureError: the child died, did not answer in time or reported a fault of its own.
            SandboxUnavailableError: this host cannot isolate a submission as the mode demands.
        """
        self.start()
        budget_s = len(job.assignment.cases) * job.assignment.limits.wall_s + _SPARE_S
        answer = self._exchange(_request(job), budget_s)
        match answer.get("kind"):
            case "result":
                return _result(answer)
            case "unavailable":
                raise SandboxUnavailableError(answer["message"])
            case _:
                raise InfrastructureError(answer.get("message", "the grading process answered nonsense"))

    def abort(self) -> None:
        """Kill the child, from any thread; a grading under way raises InfrastructureError."""
        process = self._process
        if process is not None and process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)

    def close(self) -> None:
        """End the child and everything it started; idempotent, only from the thread that grades."""
        if self._channel is not None:
            self._channel.close()
            self._channel = None
        if self._process is not None:
            self.abort()
            self._process.wait()
            self._process = None

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _exchange(self, request: dict[str, Any], budget_s: float) -> dict[str, Any]:
        assert self._channel is not None
        self._channel.settimeout(budget_s)
        try:
            send_message(self._channel, request)
            answer = receive_message(self._channel)
        except (OSError, ValueError) as error:
            self.close()
            raise InfrastructureError(
                f"the grading process failed: {error or type(error).__name__}"
            ) from error
        if answer is None:
            code = self._process.wait() if self._process else None
            self.close()
            raise InfrastructureError(f"the grading process ended unexpectedly (exit code {code})")
        return answer


def send_message(channel: socket.socket, message: dict[str, Any]) -> None:
    """Send one JSON message between parent and grading process."""
    data = json.dumps(message, ensure_ascii=False).encode()
    channel.sendall(_LENGTH.pack(len(data)) + data)


def receive_message(channel: socket.socket) -> dict[str, Any] | None:
    """Receive one JSON message; None when the other end has closed."""
    header = _receive_exactly(channel, _LENGTH.size)
    if header is None:
        return None
    data = _receive_exactly(channel, _LENGTH.unpack(header)[0])
    if data is None:
        return None
    message: dict[str, Any] = json.loads(data)
    return message


def job_from_message(message: dict[str, Any]) -> GradingJob:
    """Rebuild the job that `Slot.grade` sent."""
    return from_plain(GradingJob, {**message["job"], "source": base64.b64decode(message["source"])})


def result_message(result: GradingResult) -> dict[str, Any]:
    """Return the message that carries `result` to the parent."""
    return {
        "kind": "result",
        "report": to_plain(result.report),
        "trajectories": {case: data.decode() for case, data in result.trajectories.items()},
        "measurements": to_plain(result.measurements),
    }


def _request(job: GradingJob) -> dict[str, Any]:
    return {
        "kind": "grade",
        "job": {"file_name": job.file_name, "assignment": to_plain(job.assignment)},
        "source": base64.b64encode(job.source).decode(),
    }


def _result(message: dict[str, Any]) -> GradingResult:
    return GradingResult(
        report=from_plain(GradeReport, message["report"]),
        trajectories={case: text.encode() for case, text in message["trajectories"].items()},
        measurements=from_plain(Measurements, message["measurements"]),
    )


def _receive_exactly(channel: socket.socket, size: int) -> bytes | None:
    data = bytearray()
    while len(data) < size:
        part = channel.recv(min(size - len(data), 1 << 20))
        if not part:
            return None
        data += part
    return bytes(data)
