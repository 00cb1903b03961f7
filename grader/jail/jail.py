"""One confined process as its episode sees it: frames in, frames out, limits kept, an account at the end."""

import _socket
import select
import struct
import time
from collections.abc import Callable
from types import TracebackType
from typing import Final, Self

from grader.contracts.errors import ProtocolError, SandboxError
from grader.contracts.limits import Limits
from grader.jail import policy
from grader.jail.clocks import TICK_NS, Clocks
from grader.jail.ends import End, Judgement, judge
from grader.jail.frames import FrameReader, pack
from grader.jail.process import ProcessHandle
from grader.jail.report import JailReport, Verdict
from grader.jail.streams import Capture

_RECEIVE_BYTES: Final = 65_536
_BACKLOG_MAX_BYTES: Final = 8 * policy.FRAME_MAX_BYTES
_GLANCE_EVERY_NS: Final = 4 * TICK_NS
_TICK_TIMEVAL: Final = struct.pack("@ll", 0, TICK_NS // 1000)


class Jail:
    """A run in progress; use it as a context manager, or call `close`.

    Frames are ``u32 length`` and body, little-endian. Nothing here waits for ever: a script that owes a
    frame is ended by its CPU limit, its output limit, by sleeping where nothing can wake it, or at last by
    the wall limit, which counts as trouble of the host.
    """

    def __init__(
        self,
        channel: _socket.socket,
        process: ProcessHandle,
        captures: tuple[Capture, Capture],
        limits: Limits,
        reap: Callable[[], tuple[int, int, int]],
    ) -> None:
        self._channel = channel
        self._process = process
        self._stdout, self._stderr = captures
        self._limits = limits
        self._reap = reap
        self._reader = FrameReader()
        self._channel_ended = False
        self._verdict: Verdict | None = None
        self._detail = ""
        self._report: JailReport | None = None
        self._is_closed = False
        self._clocks = Clocks(process, limits)
        self._next_glance_ns = 0
        channel.setsockopt(_socket.SOL_SOCKET, _socket.SO_RCVTIMEO, _TICK_TIMEVAL)
        channel.setsockopt(_socket.SOL_SOCKET, _socket.SO_SNDTIMEO, _TICK_TIMEVAL)
        self._poll = select.poll()
        for capture in captures:
            self._poll.register(capture.descriptor, select.POLLIN)
        self._end_poll = select.poll()
        if process.pidfd is not None:
            self._poll.register(process.pidfd, select.POLLIN)
            self._end_poll.register(process.pidfd, select.POLLIN)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    # ------------------------------------------------------------------------------------------- frames

    def send(self, body: bytes) -> None:
        """Send one frame. When the process has ended, or ends meanwhile, the frame is dropped silently."""
        data = memoryview(pack(body))
        self._clocks.forget_look()
        while data and self._verdict is None and not self._channel_ended:
            try:
                data = data[self._channel.send(data) :]
            except (BlockingIOError, InterruptedError):
                self._tend(select.POLLOUT | select.POLLIN)
                self._take_while_sending()
            except OSError:
                return

    def receive(self) -> bytes | None:
        """Return the body of the next frame, or None once the process has ended or was ended by a limit.

        Frames that were sent before a limit struck are still returned first.
        """
        while True:
            try:
                frame = self._reader.next()
            except ProtocolError as error:
                self._end(Verdict.PROTOCOL, str(error))
                return None
            if frame is not None:
                self._glance()
                return frame
            if self._channel_ended or self._verdict is Verdict.PROTOCOL:
                self._await_end()
                return None
            if self._verdict is None:
                self._take()
            else:
                self._take_rest()

    def limit_cpu(self, extra_s: float) -> None:
        """Leave the script at most `extra_s` more CPU seconds from now, and never more than it had."""
        self._clocks.limit_cpu(extra_s)

    def _take(self) -> None:
        """Receive once; look after everything else when there is nothing to receive."""
        try:
            data = self._channel.recv(_RECEIVE_BYTES)
        except (BlockingIOError, InterruptedError):
            while self._verdict is None and not self._tend(select.POLLIN):
                pass
            return
        except OSError:
            data = b""
        if not data:
            self._channel_ended = True
            return
        self._clocks.note_life()
        self._clocks.forget_look()
        self._keep(data)
        self._check_clocks()

    def _glance(self) -> None:
        """Now and then, take what the script sent and printed while frames still wait.

        The episode may simulate for long; yet when the script was last busy must be known (`Clocks.was_quiet`).
        """
        now_ns = time.monotonic_ns()
        if self._verdict is not None or now_ns < self._next_glance_ns:
            return
        self._next_glance_ns = now_ns + _GLANCE_EVERY_NS
        self._drain()
        if not self._channel_ended and self._reader.pending_bytes < _RECEIVE_BYTES:
            self._take_at_once()
        self._clocks.look()

    def _take_at_once(self) -> None:
        """Receive what is there already."""
        try:
            data = self._channel.recv(_RECEIVE_BYTES, _socket.MSG_DONTWAIT)
        except OSError:
            return
        self._channel_ended = not data
        if data:
            self._clocks.note_life()
        self._keep(data)

    def _take_rest(self) -> None:
        """Receive once from a process that was killed: what it had sent before counts, then the channel ends."""
        try:
            data = self._channel.recv(_RECEIVE_BYTES)
        except (BlockingIOError, InterruptedError):
            self._channel_ended = self._has_ended()  # somebody else holds its end: wait no longer
            return
        except OSError:
            data = b""
        self._channel_ended = not data
        self._keep(data)

    def _keep(self, data: bytes) -> None:
        try:
            self._reader.feed(data)
        except ProtocolError as error:
            self._end(Verdict.PROTOCOL, str(error))

    def _take_while_sending(self) -> None:
        """Make room for a process that cannot read because it waits to write."""
        if self._reader.pending_bytes > _BACKLOG_MAX_BYTES:
            self._end(Verdict.PROTOCOL, "the script sends without reading what it asked for")
            return
        self._take_at_once()

    # ------------------------------------------------------------------------------------------- limits

    def _tend(self, channel_events: int) -> bool:
        """Wait a tick for anything to happen, capture output, check every limit.

        Returns:
            Whether the channel has one of `channel_events` (0: leave the channel alone).
        """
        if channel_events:
            self._poll.register(self._channel, channel_events)
        ready = self._poll.poll(TICK_NS // 1_000_000)
        if channel_events:
            self._poll.unregister(self._channel)
        self._drain()
        self._check_clocks()
        if self._verdict is None and self._clocks.sleeps_for_ever() and not self._has_ended():
            self._end(Verdict.STALLED, "the script waits in a call that nothing can end")
        return any(descriptor == self._channel.fileno() for descriptor, _ in ready)

    def _await_end(self) -> None:
        """Wait, under all limits, for a process that has closed its channel."""
        while self._verdict is None and not self._has_ended():
            self._tend(0)

    def _has_ended(self) -> bool:
        if self._process.pidfd is None:
            return self._stdout.ended and self._stderr.ended
        return bool(self._end_poll.poll(0))

    def _drain(self) -> None:
        for capture in (self._stdout, self._stderr):
            if not capture.ended:
                if capture.drain():
                    self._clocks.note_life()
                if capture.ended:
                    self._poll.unregister(capture.descriptor)
        if self._stdout.total_bytes + self._stderr.total_bytes > self._limits.output_bytes:
            self._end(Verdict.OUTPUT_LIMIT, f"more than {self._limits.output_bytes} bytes were printed")

    def _check_clocks(self) -> None:
        passed = self._clocks.verdict()
        if passed is not None:
            self._end(*passed)

    def _end(self, verdict: Verdict, detail: str) -> None:
        if self._verdict is None:
            self._verdict, self._detail = verdict, detail
        self._process.kill()

    # ---------------------------------------------------------------------------------------------- end

    def close(self) -> JailReport:
        """End the process if it still runs, reap it, and return the account. Further calls end the same way.

        Raises:
            SandboxError: the zygote could not account for the process.
        """
        if self._report is None:
            if self._is_closed:  # the descriptors and the number may be somebody else's by now
                raise SandboxError("the sandbox's process could not account for the run")
            self._is_closed = True
            try:
                self._report = self._account()
            finally:
                self._process.close()
                self._channel.close()
                self._stdout.close()
                self._stderr.close()
        return self._report

    def _account(self) -> JailReport:
        ended_itself = self._has_ended()
        if not ended_itself:
            self._process.kill()
        cpu_before_ns = self._process.cpu_ns()
        wait_status, cpu_ns, peak_bytes = self._reap()
        wall_ns = self._clocks.wall_ns
        self._drain_rest()
        verdict, exit_code, signal_name, detail = self._judge(
            End(
                wait_status=wait_status,
                by_itself=ended_itself,
                cpu_ns=cpu_before_ns,
                peak_bytes=peak_bytes,
            )
        )
        return JailReport(
            verdict=verdict,
            exit_code=exit_code,
            signal=signal_name,
            detail=detail,
            cpu_ns=cpu_ns,
            peak_bytes=peak_bytes,
            wall_ns=wall_ns,
            stdout=self._stdout.stream(),
            stderr=self._stderr.stream(),
            settled=self._has_settled(verdict),
        )

    def _drain_rest(self) -> None:
        deadline_ns = time.monotonic_ns() + policy.DRAIN_LIMIT_NS
        while not (self._stdout.ended and self._stderr.ended) and time.monotonic_ns() < deadline_ns:
            self._poll.poll(1)
            self._drain()

    def _has_settled(self, verdict: Verdict) -> bool:
        """Return whether the streams do not depend on the moment of the kill (see `JailReport`)."""
        if verdict in (Verdict.CPU_LIMIT, Verdict.STALLED):
            return self._clocks.was_quiet(verdict)
        if verdict is Verdict.OUTPUT_LIMIT:  # one stream is cut at the limit; of another, who knows
            return 0 in (self._stdout.total_bytes, self._stderr.total_bytes)
        return self._verdict is not Verdict.PROTOCOL

    def _judge(self, end: End) -> Judgement:
        if self._verdict is not None:
            return self._verdict, None, None, self._detail
        cut = self._channel_ended and self._reader.pending_bytes > 0
        return judge(end, self._clocks, self._limits.memory_bytes, cut_frame=cut)
