"""A slot: one supervised grading process, seen from the parent.

The child (`child`) holds PyBullet, the sandbox's zygote and the checks. Parent and child exchange messages over
two pipes (`Channel`) and trust each other. When the child dies or does not answer in time, the job fails with an
`InfrastructureError`; the next one starts a new child, so the caller may try again.
"""

import json
import os
import select
import signal
import threading
import time
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from types import TracebackType
from typing import Any, Final

from grader.contracts.errors import (
    GraderError,
    InfrastructureError,
    NoRoomError,
    SandboxUnavailableError,
    lacks_room,
)
from grader.contracts.explanation import Explanation
from grader.contracts.extras import MissingExtraError
from grader.contracts.grading import GradingJob, GradingResult, RunProgress, WorldRequest
from grader.contracts.python import Self
from grader.contracts.record import from_plain, to_plain
from grader.contracts.report import Measurements, report_from
from grader.grading.launch import Child, launch
from grader.jail import bounds

NO_ROOM_CODE: Final = 75
"""Exit code of a grading process that the host refused memory or a thread. One that the kernel ended for lack of
memory was killed; nobody else kills it."""

_SPARE_S: Final = 30.0  # for importing the physics on a loaded machine, the checks and encoding
_EXIT_S: Final = 1.0  # a child that has closed its pipe is about to end
_LENGTH_BYTES: Final = 4
_READ_BYTES: Final = 1 << 20
_MESSAGE_MAX_BYTES: Final = 256 << 20  # a minute of motion is a third of a MiB


@dataclass(frozen=True, slots=True, kw_only=True)
class SlotConfig:
    """How a grading process isolates submissions.

    Attributes:
        mode: ``strict``, ``best-effort`` or ``dev`` (see `grader.jail.layers.Mode`).
        niceness: priority number of the process and of what it starts, so that a service answers while it grades.
    """

    mode: str = "strict"
    niceness: int = 0


class Channel:
    """Messages over a pair of pipes: four bytes of length, little-endian, JSON in UTF-8, then blobs.

    What is bytes already (a script, a report, trajectories) is a blob: in JSON it would be escaped on one side and
    read again on the other. The message says under ``blobs`` how long each is.
    """

    def __init__(self, reading: int, writing: int) -> None:
        """Take over two descriptors; they are not handed on to other processes."""
        self._reading = reading
        self._writing = writing
        for descriptor in (reading, writing):
            os.set_inheritable(descriptor, False)
            os.set_blocking(descriptor, False)

    def send(
        self, message: dict[str, Any], blobs: Sequence[bytes] = (), budget_s: float | None = None
    ) -> None:
        """Send one message, of plain values and contracts, with what is bytes already.

        Raises OSError: the other end is closed, or (TimeoutError) did not take it within `budget_s`.
        """
        if blobs:
            message = {**message, "blobs": [len(blob) for blob in blobs]}
        data = json.dumps(message, ensure_ascii=False, default=to_plain).encode()
        view = memoryview(b"".join((len(data).to_bytes(_LENGTH_BYTES, "little"), data, *blobs)))
        deadline_s = _deadline(budget_s)
        while view:
            try:
                view = view[os.write(self._writing, view) :]
            except BlockingIOError:
                _wait(self._writing, select.POLLOUT, deadline_s)

    def receive(self, budget_s: float | None = None) -> dict[str, Any] | None:
        """Receive one message, its ``blobs`` as bytes; None when the other end is closed, in a message or not.

        Raises:
            OSError: (TimeoutError) it did not come within `budget_s`.
            ValueError: what came is no message.
        """
        deadline_s = _deadline(budget_s)
        header = self._exactly(_LENGTH_BYTES, deadline_s)
        size = _bounded(int.from_bytes(header, "little"))
        data = self._exactly(size, deadline_s)
        if len(header) < _LENGTH_BYTES or len(data) < size:
            return None
        message = json.loads(data)
        if not isinstance(message, dict):
            raise ValueError("a message is no object")
        if "blobs" in message:
            sizes = _sizes(message["blobs"])
            whole = self._exactly(_bounded(sum(sizes)), deadline_s)
            if len(whole) < sum(sizes):
                return None
            message["blobs"] = list(_cut(whole, sizes))
        return message

    def close(self) -> None:
        """Close both ends held here."""
        os.close(self._reading)
        os.close(self._writing)

    def _exactly(self, size: int, deadline_s: float | None) -> bytes:
        """Return `size` bytes, or fewer when the other end is closed."""
        data = bytearray()
        while len(data) < size:
            try:
                part = os.read(self._reading, min(size - len(data), _READ_BYTES))
            except BlockingIOError:
                _wait(self._reading, select.POLLIN, deadline_s)
                continue
            if not part:
                break
            data += part
        return bytes(data)


class Slot:
    """Parent side of one grading process. Not thread-safe, but for `abort`: one thread owns a slot."""

    def __init__(self, config: SlotConfig) -> None:
        self._config = config
        self._process: _Process | None = None
        self._channel: Channel | None = None

    def start(self) -> None:
        """Start the grading process without waiting for it to be ready; harmless when it runs.

        Raises InfrastructureError: it could not be started.
        """
        if self._process is not None and self._process.exit_code() is None:
            return
        self.close()
        try:
            child = launch()
        except OSError as error:
            kind = NoRoomError if lacks_room(error) else InfrastructureError
            raise kind(f"the grading process could not be started: {error}") from error
        self._process = _Process(child)
        self._channel = Channel(child.answers, child.requests)
        self._send(asdict(self._config), _SPARE_S)

    def grade(
        self,
        job: GradingJob,
        on_run: Callable[[], None] = lambda: None,
        on_progress: Callable[[RunProgress], None] | None = None,
    ) -> GradingResult:
        """Grade `job` in the child; call `on_run` here whenever a run of the script has begun there.

        With `on_progress` the child also tells now and then how far a run is, which costs a little time.

        Raises:
            InfrastructureError: the child died, did not answer in time or reported a fault of its own; a
                `NoRoomError` if the host had no process, thread or memory to spare for it or for a run.
            SandboxUnavailableError: this host cannot isolate a submission as the mode demands.
        """
        self.start()
        # From one answer to the next, not for all runs: the child says when each of them begins.
        budget_s, has_run = bounds.longest_run_s(job.assignment.limits.wall_s) + _SPARE_S, False
        self._send(_request(job, tells=on_progress is not None), budget_s, [job.source])
        try:
            while (kind := (answer := self._receive(budget_s)).get("kind")) in ("running", "progress"):
                if kind == "running":
                    has_run = True
                    on_run()
                elif on_progress is not None:
                    on_progress(self._progress(answer))
        except NoRoomError as error:
            if not has_run:
                raise
            raise InfrastructureError(str(error)) from error  # the script may have taken the room
        if kind != "result":
            raise _fault(answer)
        return self._result(answer)

    def explain(
        self,
        job: GradingJob,
        hidden: Collection[str] = (),
        before_each: Callable[[], None] = lambda: None,
    ) -> Explanation:
        """Look in the child for changes of a graded script that gain marks.

        Args:
            job: as it was graded.
            hidden: items that nothing is to be told of; they are not looked at.
            before_each: called before each grading; it may wait, or raise to give the search up.

        Raises:
            InfrastructureError, SandboxUnavailableError: as `grade`. The marks stand, however it ends.
        """
        self.start()
        cases = len(job.assignment.cases)
        budget_s = cases * bounds.longest_run_s(job.assignment.limits.wall_s) + _SPARE_S
        self._send({**_request(job), "kind": "explain", "hidden": sorted(hidden)}, budget_s, [job.source])
        while (answer := self._receive(budget_s)).get("kind") == "trial":
            try:
                before_each()
            except BaseException:
                self.close()  # the child waits in the middle of its search
                raise
            self._send({"kind": "try"}, budget_s)
        if answer.get("kind") != "explanation":
            raise _fault(answer)
        try:
            return from_plain(Explanation, answer["explanation"])
        except (KeyError, ValueError) as error:
            raise self._failed(error) from error

    def abort(self) -> None:
        """Kill the child, from any thread; a grading under way raises InfrastructureError."""
        process = self._process
        if process is not None:
            process.kill()

    def close(self) -> None:
        """End the child and everything it started; idempotent, only from the thread that grades."""
        if self._channel is not None:
            self._channel.close()
            self._channel = None
        if self._process is not None:
            self._process.end()
            self._process = None

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _send(self, message: dict[str, Any], budget_s: float, blobs: Sequence[bytes] = ()) -> None:
        assert self._channel is not None
        try:
            self._channel.send(message, blobs, budget_s)
        except BrokenPipeError:
            return  # it has ended; `_receive` reports how
        except OSError as error:
            raise self._failed(error) from error

    def _receive(self, budget_s: float) -> dict[str, Any]:
        assert self._channel is not None
        assert self._process is not None
        try:
            answer = self._channel.receive(budget_s)
        except (OSError, ValueError) as error:
            raise self._failed(error) from error
        if answer is None:
            code = self._process.wait(_EXIT_S)
            self.close()
            kind = NoRoomError if code in (NO_ROOM_CODE, -signal.SIGKILL) else InfrastructureError
            raise kind(f"the grading process ended unexpectedly (exit code {code})")
        return answer

    def _progress(self, answer: dict[str, Any]) -> RunProgress:
        try:
            return from_plain(RunProgress, answer["progress"])
        except (KeyError, ValueError) as error:
            raise self._failed(error) from error

    def _result(self, answer: dict[str, Any]) -> GradingResult:
        try:
            report, *trajectories = answer["blobs"]
            return GradingResult(
                report=report_from(report),
                encoded=report,
                trajectories=dict(zip(answer["trajectories"], trajectories, strict=True)),
                measurements=from_plain(Measurements, answer["measurements"]),
                requests={
                    case: tuple(from_plain(WorldRequest, request) for request in requests)
                    for case, requests in answer["requests"].items()
                },
                unmet=tuple(map(str, answer["unmet"])),
            )
        except (KeyError, AttributeError, TypeError, ValueError) as error:
            raise self._failed(error) from error

    def _failed(self, error: Exception) -> InfrastructureError:
        self.close()
        return InfrastructureError(f"the grading process failed: {str(error) or type(error).__name__}")


class _Process:
    """The child and its process group; `kill` may be called from any thread."""

    def __init__(self, child: Child) -> None:
        self._pid = child.pid
        self._exit_code: int | None = None
        self._lock = threading.Lock()  # the id of a reaped process may belong to another one by now

    def exit_code(self) -> int | None:
        """Return the exit code, as `subprocess` counts; None while it runs."""
        with self._lock:
            if self._exit_code is None:
                pid, status = os.waitpid(self._pid, os.WNOHANG)
                if pid:
                    self._exit_code = os.waitstatus_to_exitcode(status)
            return self._exit_code

    def wait(self, budget_s: float) -> int | None:
        """Wait up to `budget_s` for its end; return the exit code, None if it still runs."""
        deadline_s = time.monotonic() + budget_s
        while (code := self.exit_code()) is None and time.monotonic() < deadline_s:
            time.sleep(0.005)
        return code

    def kill(self) -> None:
        """Kill the group, unless the child was seen to have ended."""
        with self._lock:
            if self._exit_code is None:
                os.killpg(self._pid, signal.SIGKILL)

    def end(self) -> None:
        """Kill the group and reap the child."""
        self.kill()
        with self._lock:
            if self._exit_code is None:
                _, status = os.waitpid(self._pid, 0)
                self._exit_code = os.waitstatus_to_exitcode(status)


def job_from_message(message: dict[str, Any]) -> GradingJob:
    """Rebuild the job that `Slot.grade` sent."""
    (source,) = message["blobs"]
    return from_plain(GradingJob, {**message["job"], "source": source})


def result_message(result: GradingResult) -> tuple[dict[str, Any], list[bytes]]:
    """Return the message that carries `result` to the parent, and its blobs: the report, then trajectories."""
    message = {
        "kind": "result",
        "trajectories": list(result.trajectories),
        "measurements": result.measurements,
        "requests": result.requests,
        "unmet": result.unmet,
    }
    return message, [result.report.canonical_bytes(), *result.trajectories.values()]


def _fault(answer: Mapping[str, Any]) -> GraderError:
    """Return the error that the child reports."""
    message = str(answer.get("message", "the grading process answered nonsense"))
    match answer.get("kind"):
        case "unavailable":
            return SandboxUnavailableError(message)
        case "missing_extra":
            return MissingExtraError.named(message)
        case "no_room":
            return NoRoomError(message)
        case _:
            return InfrastructureError(message)


def _request(job: GradingJob, *, tells: bool = False) -> dict[str, Any]:
    return {
        "kind": "grade",
        "job": {"file_name": job.file_name, "assignment": job.assignment},
        "tells": tells,
    }


def _bounded(size: int) -> int:
    if size > _MESSAGE_MAX_BYTES:
        raise ValueError(f"a message of {size} bytes was announced")
    return size


def _sizes(announced: Any) -> list[int]:
    if not isinstance(announced, list) or not all(type(value) is int and value >= 0 for value in announced):
        raise ValueError("the sizes of a message's blobs are no numbers")
    return announced


def _cut(whole: bytes, sizes: Sequence[int]) -> Iterator[bytes]:
    begin = 0
    for size in sizes:
        yield whole[begin : begin + size]
        begin += size


def _deadline(budget_s: float | None) -> float | None:
    return None if budget_s is None else time.monotonic() + budget_s


def _wait(descriptor: int, event: int, deadline_s: float | None) -> None:
    """Wait until `descriptor` is ready. Raises TimeoutError: it was not by `deadline_s`."""
    poll = select.poll()
    poll.register(descriptor, event)
    left_ms = None if deadline_s is None else max(0.0, deadline_s - time.monotonic()) * 1e3
    if not poll.poll(left_ms):
        raise TimeoutError("no answer in time")
