"""One confined process as its episode sees it: frames in, frames out, limits kept, an account at the end."""

import _socket
import os
import select
import struct
import time
from collections import deque
from collections.abc import Callable
from types import TracebackType
from typing import Final

from grader.contracts.assignment import Limits
from grader.contracts.errors import ProtocolError, SandboxError
from grader.contracts.outcome import Stream
from grader.contracts.python import Self
from grader.jail import bounds
from grader.jail.cores import SharedCore
from grader.jail.ending import TICK_NS, Clocks, Ending, JailReport, KernelAccount, RunEnd, explain
from grader.jail.process import ProcessHandle

_RECEIVE_BYTES: Final = 65_536
_BACKLOG_MAX_BYTES: Final = 8 * bounds.FRAME_MAX_BYTES
_GLANCE_EVERY_NS: Final = 4 * TICK_NS
_GATHER_S: Final = 0.001
"""For so long the frames of a script that runs ahead may come together: to be woken for each costs both sides."""
_CHECK_EVERY_NS: Final = TICK_NS // 5
"""While frames come one by one: to read all clocks costs as much as to receive a frame."""
_TICK_TIMEVAL: Final = struct.pack("@ll", 0, TICK_NS // 1000)
_HEADER: Final = struct.Struct("<I")
_READ_BYTES: Final = 65_536
_READS_PER_DRAIN: Final = 8


def pack(body: bytes) -> bytes:
    """Return `body` as a frame: its length as u32, little-endian, then itself."""
    return _HEADER.pack(len(body)) + body


class FrameReader:
    """Collects bytes in pieces of any size and gives back frames.

    A frame's length is checked before anything is kept for it, and the number of frames and bytes of a whole
    run is bounded.
    """

    def __init__(self) -> None:
        self._buffer = bytearray()
        self._position = 0
        self._frames = 0
        self._received_bytes = 0

    @property
    def pending_bytes(self) -> int:
        """Bytes received that have not been given back."""
        return len(self._buffer) - self._position

    def feed(self, data: bytes) -> None:
        """Take `data` as received.

        Raises ProtocolError: the run has sent more than `bounds.CHANNEL_MAX_BYTES`.
        """
        self._received_bytes += len(data)
        if self._received_bytes > bounds.CHANNEL_MAX_BYTES:
            raise ProtocolError(f"more than {bounds.CHANNEL_MAX_BYTES} bytes were sent")
        del self._buffer[: self._position]
        self._position = 0
        self._buffer += data

    def next(self) -> bytes | None:
        """Return the body of the next frame, or None while it is not complete.

        Raises ProtocolError: its length is impossible, or the run has sent more than `bounds.FRAMES_MAX`.
        """
        start = self._position + _HEADER.size
        if len(self._buffer) < start:
            return None
        (length,) = _HEADER.unpack_from(self._buffer, self._position)
        if not 1 <= length <= bounds.FRAME_MAX_BYTES:
            raise ProtocolError(f"a frame announced a length of {length} bytes")
        if len(self._buffer) < start + length:
            return None
        if self._frames == bounds.FRAMES_MAX:
            raise ProtocolError(f"more than {bounds.FRAMES_MAX} messages were sent")
        self._frames += 1
        self._position = start + length
        return bytes(self._buffer[start : self._position])


class Capture:
    """Reads one pipe without blocking and keeps its first and last 64 KiB.

    What comes after `limit_bytes` is counted but not kept: where a flood is cut then depends on the script,
    not on how fast it was read.

    Attributes:
        total_bytes: everything read so far.
        ended: every writer has closed its end.
    """

    def __init__(self, descriptor: int, limit_bytes: int) -> None:
        self.descriptor = descriptor
        self._limit_bytes = limit_bytes
        self.total_bytes = 0
        self.ended = False
        self._head = bytearray()
        self._tail: deque[bytes] = deque()
        self._tail_bytes = 0
        os.set_blocking(descriptor, False)

    def drain(self) -> bool:
        """Take what the pipe holds; return whether there was anything (at most half a MiB per call)."""
        for turn in range(_READS_PER_DRAIN):
            try:
                data = os.read(self.descriptor, _READ_BYTES)
            except BlockingIOError:
                return turn > 0
            if not data:
                self.ended = True
                return turn > 0
            self._keep(data)
        return True

    def _keep(self, data: bytes) -> None:
        within_limit = max(0, self._limit_bytes - self.total_bytes)
        self.total_bytes += len(data)
        data = data[:within_limit]
        room = bounds.STREAM_HEAD_BYTES - len(self._head)
        self._head += data[:room]
        rest = data[room:] if room else data
        if not rest:
            return
        self._tail.append(rest)
        self._tail_bytes += len(rest)
        while self._tail_bytes - len(self._tail[0]) >= bounds.STREAM_TAIL_BYTES:
            self._tail_bytes -= len(self._tail.popleft())

    def close(self) -> None:
        """Close the pipe; what was captured stays."""
        os.close(self.descriptor)

    def stream(self) -> Stream:
        """Return the captured text, decoded with replacement."""
        tail = b"".join(self._tail)[-bounds.STREAM_TAIL_BYTES :]
        dropped = min(self.total_bytes, self._limit_bytes) - len(self._head) - len(tail)
        head = bytes(self._head)
        if not dropped:
            return Stream(text=(head + tail).decode(errors="replace"))
        marker = f"\n… {dropped} bytes left out …\n"
        text = head.decode(errors="replace") + marker + tail.decode(errors="replace")
        return Stream(text=text, dropped_bytes=dropped)


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
        self._ending: Ending | None = None  # by a limit or a fault of the protocol; None: by itself
        self._report: JailReport | None = None
        self._is_closed = False
        self._clocks = Clocks(process, limits)
        self._core = SharedCore(process.pid)
        self._runs_ahead = False
        self._next_glance_ns = self._next_check_ns = 0
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
        while data and self._ending is None and not self._channel_ended:
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
                self._end(Ending(RunEnd.PROTOCOL, str(error)))
                return None
            if frame is not None:
                self._glance()
                return frame
            if self._channel_ended or self._broke_protocol:
                self._await_end()
                return None
            if self._ending is None:
                self._take()
            else:
                self._take_rest()

    def printed(self) -> tuple[Stream, Stream]:
        """Return what was captured so far of standard output and standard error."""
        return self._stdout.stream(), self._stderr.stream()

    def take_turns(self, in_turns: bool) -> None:
        """Set whether both sides now wait for each other, or the script runs ahead. This only affects speed."""
        self._runs_ahead = not in_turns
        if in_turns:
            self._core.share()
        else:
            self._core.part()

    def gather_threads(self) -> None:
        """Note that the script's threads take turns from now on. This only affects speed."""
        self._core.gather()

    def limit_cpu(self, extra_s: float) -> None:
        """Leave the script at most `extra_s` more CPU seconds from now, and never more than it had."""
        self._clocks.limit_cpu(extra_s)

    def _take(self) -> None:
        """Receive once; while there is nothing to receive, capture output and check the limits."""
        if self._runs_ahead:
            time.sleep(_GATHER_S)
        try:
            data = self._channel.recv(_RECEIVE_BYTES)
        except (BlockingIOError, InterruptedError):
            while self._ending is None and not self._tend(select.POLLIN):
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
        if time.monotonic_ns() >= self._next_check_ns:
            self._check_clocks()

    def _glance(self) -> None:
        """Now and then, take what the script has sent and printed since, though frames still wait to be read.

        The episode may simulate for long; yet when the script was last busy must be known (`Clocks.was_quiet`).
        """
        now_ns = time.monotonic_ns()
        if self._ending is not None or now_ns < self._next_glance_ns:
            return
        self._next_glance_ns = now_ns + _GLANCE_EVERY_NS
        self._drain()
        if not self._channel_ended and self._reader.pending_bytes < _RECEIVE_BYTES:
            self._take_at_once()
        self._check_clocks()  # a script may send frames as fast as they are worked on, so that none is waited for

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
            # Another process may still hold the other end open: do not wait for it.
            self._channel_ended = self._has_ended()
            return
        except OSError:
            data = b""
        self._channel_ended = not data
        self._keep(data)

    def _keep(self, data: bytes) -> None:
        try:
            self._reader.feed(data)
        except ProtocolError as error:
            self._end(Ending(RunEnd.PROTOCOL, str(error)))

    def _take_while_sending(self) -> None:
        """Make room for a process that cannot read because it waits to write."""
        if self._reader.pending_bytes > _BACKLOG_MAX_BYTES:
            self._end(Ending(RunEnd.PROTOCOL, "the script sends without reading what it asked for"))
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
        if ready or self._ending is not None:
            return any(descriptor == self._channel.fileno() for descriptor, _ in ready)
        # Only a script that has sent nothing is waited for: one that has asked sleeps until it is answered.
        if self._clocks.sleeps_for_ever() and not self._has_ended():
            self._end(Ending(RunEnd.STALLED, "the script waits in a call that nothing can end"))
        return False

    def _await_end(self) -> None:
        """Wait, under all limits, for a process that has closed its channel."""
        while self._ending is None and not self._has_ended():
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
            self._end(
                Ending(RunEnd.OUTPUT_LIMIT, f"more than {self._limits.output_bytes} bytes were printed")
            )

    def _check_clocks(self) -> None:
        self._next_check_ns = time.monotonic_ns() + _CHECK_EVERY_NS
        passed = self._clocks.passed_limit()
        if passed is not None:
            self._end(passed)

    def _end(self, ending: Ending) -> None:
        """Kill the process; the first reason to do so is the one that is reported."""
        self._ending = self._ending or ending
        self._process.kill()

    @property
    def _broke_protocol(self) -> bool:
        return self._ending is not None and self._ending.end is RunEnd.PROTOCOL

    # ---------------------------------------------------------------------------------------------- end

    def close(self) -> JailReport:
        """End the process if it still runs, reap it, and return the account. Further calls end the same way.

        Raises SandboxError: the zygote could not account for the process.
        """
        if self._report is None:
            if self._is_closed:  # descriptors and process id may have been reused by now
                raise SandboxError("the sandbox's process could not account for the run")
            self._is_closed = True
            self._core.leave()
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
        ending = self._ending or explain(
            KernelAccount(
                wait_status=wait_status, by_itself=ended_itself, cpu_ns=cpu_before_ns, peak_bytes=peak_bytes
            ),
            self._clocks,
            self._limits.memory_bytes,
            cut_frame=self._channel_ended and self._reader.pending_bytes > 0,
        )
        return JailReport(
            **ending._asdict(),
            cpu_ns=cpu_ns,
            peak_bytes=peak_bytes,
            wall_ns=wall_ns,
            stdout=self._stdout.stream(),
            stderr=self._stderr.stream(),
            settled=self._has_settled(ending.end),
        )

    def _drain_rest(self) -> None:
        deadline_ns = time.monotonic_ns() + bounds.DRAIN_LIMIT_NS
        while not (self._stdout.ended and self._stderr.ended) and time.monotonic_ns() < deadline_ns:
            self._poll.poll(1)
            self._drain()

    def _has_settled(self, end: RunEnd) -> bool:
        """Return whether the streams do not depend on the moment of the kill (see `JailReport`)."""
        if end in (RunEnd.CPU_LIMIT, RunEnd.STALLED):
            return self._clocks.was_quiet(end)
        if end is RunEnd.OUTPUT_LIMIT:  # one stream is cut at the limit; where the other one is cut is chance
            return 0 in (self._stdout.total_bytes, self._stderr.total_bytes)
        return not self._broke_protocol
