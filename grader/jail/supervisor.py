"""The trusted side of a zygote: start it, configure it, have processes forked and reaped.

`start_interpreter` starts a bare Python. It gets ready on another core while this process imports the physics,
which takes about as long; its configuration follows over a socket (`Zygote`). Each process that it forks confines
itself and waits (`Confined`), until it is begun as a run (`jail.Jail`) or discarded.
"""

import _socket
import array
import json
import os
import signal
import sys
import threading
import time
from collections.abc import Callable
from contextlib import ExitStack, suppress
from dataclasses import asdict
from typing import Final

from grader.contracts.assignment import Limits
from grader.contracts.errors import NoRoomError, SandboxError, lacks_room
from grader.contracts.python import SAFE_PATH
from grader.contracts.record import Record
from grader.jail import bounds, libc, syscalls
from grader.jail.jail import Capture, Jail
from grader.jail.process import ProcessHandle

_ANSWER_LIMIT_S: Final = 20.0
_ANSWER_MAX_BYTES: Final = 1 << 20
_CONFINE_LIMIT_S: Final = 20.0
_LAUNCHER: Final = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
# Nothing but the standard streams and the control socket may stay open, whatever this process inherited.
_BOOTSTRAP: Final = (
    "import os, sys; control = int(sys.argv[-1]); os.closerange(3, control); "
    "os.closerange(control + 1, os.sysconf('SC_OPEN_MAX')); os.chdir('/'); "
    "sys.path[:] = [sys.argv.pop(1), *filter(None, sys.path)]; from jail.zygote import main; main()"
)
_AUTOGROUP_PAUSE_S: Final = 0.11
_AUTOGROUP_TRIES: Final = 10


class ZygoteConfig(Record):
    """The configuration of a zygote, sent once; see `zygote._prepare`. Paths are absolute."""

    shim: str
    entry: str
    preload: tuple[str, ...]
    packages: dict[str, str]
    readable: list[str]
    shown: list[str]
    masked: list[str]
    landlock: bool
    seccomp: bool
    namespaces: bool
    box_uid: int | None
    keep_read: bool
    root: str | None = None
    filters: str = syscalls.FILTER_DIRECTORY


class Zygote:
    """One warm process. Every method raises `SandboxError` when it does not do its part in time.

    Attributes:
        namespaces: whether it lives in its own namespaces; known once it is ready.
    """

    def __init__(self, config: ZygoteConfig) -> None:
        """Start the process; it prepares itself while the caller goes on (see `wait_ready`)."""
        self._lock = threading.Lock()
        self._ready = False
        self._broken = False
        self.namespaces = False
        try:
            self._process = start_interpreter()
        except OSError as error:
            raise _failed(f"the sandbox's process could not be started: {error}") from error
        self._control = self._process.control
        self._control.settimeout(_ANSWER_LIMIT_S)
        self._request(asdict(config))

    @property
    def alive(self) -> bool:
        """Whether the process is running and has kept to its protocol."""
        return not self._broken and self._process.alive

    def wait_ready(self) -> None:
        """Return once the zygote has prepared itself.

        Raises SandboxError: it could not; the message says which step failed.
        """
        with self._lock:
            if not self._ready:
                answer, _ = self._answer()
                self.namespaces = bool(answer["namespaces"])
                self._ready = True

    def fork(
        self,
        budget: tuple[float, int, int | None],
        descriptors: tuple[int, int, int],
        *,
        prove: bool = False,
    ) -> tuple[int, int | None]:
        """Have a process forked; return its number, as the zygote sees it, and its pidfd.

        Args:
            budget: CPU seconds, private bytes and threads (None: not counted).
            descriptors: channel, stdout and stderr of the new process.
            prove: look for ways out of the jail instead of waiting for a script (see `inside`).
        """
        with self._lock:
            self._request({"do": "fork", "budget": budget, "prove": prove}, *descriptors)
            answer, received = self._answer()
            return int(answer["pid"]), received[0] if received else None

    def reap(self, pid: int) -> tuple[int, int, int]:
        """Wait for the end of `pid` (as the zygote sees it); return wait status, CPU ns and peak bytes."""
        with self._lock:
            self._request({"do": "reap", "pid": pid})
            answer, _ = self._answer()
            return int(answer["status"]), int(answer["cpu_ns"]), int(answer["peak_bytes"])

    def close(self) -> None:
        """End the process and everything it started."""
        self._process.end()

    def _request(self, request: dict[str, object], *descriptors: int) -> None:
        body = json.dumps(request).encode()
        data = len(body).to_bytes(4, "little") + body
        rights = (
            [(_socket.SOL_SOCKET, _socket.SCM_RIGHTS, array.array("i", descriptors))] if descriptors else []
        )
        try:
            sent = self._control.sendmsg([data], rights)
            if sent < len(data):
                self._control.sendall(data[sent:])
        except OSError as error:
            raise SandboxError(f"the sandbox's process is gone: {error}") from error

    def _answer(self) -> tuple[dict[str, int], list[int]]:
        self._broken = True  # a late answer would be taken for that to the next request
        try:
            header, descriptors = self._header()
            header += self._exactly(4 - len(header))
            size = int.from_bytes(header, "little")
            if size > _ANSWER_MAX_BYTES:
                raise SandboxError("the sandbox's process answered nonsense")
            answer = json.loads(self._exactly(size))
        except (OSError, ValueError) as error:
            raise SandboxError(f"the sandbox's process did not answer: {error}") from error
        self._broken = False
        if "error" in answer:
            raise _failed(f"the sandbox's process could not do its part: {answer['error']}")
        return answer, descriptors

    def _header(self) -> tuple[bytes, list[int]]:
        """Receive the beginning of an answer, with at most one descriptor."""
        received = array.array("i")
        data, ancillary, _, _ = self._control.recvmsg(4, _socket.CMSG_LEN(received.itemsize))
        for level, kind, payload in ancillary:
            if (level, kind) == (_socket.SOL_SOCKET, _socket.SCM_RIGHTS):
                received.frombytes(payload[: len(payload) - len(payload) % received.itemsize])
        return data, list(received)

    def _exactly(self, size: int) -> bytes:
        data = b""
        while len(data) < size:
            part = self._control.recv(size - len(data))
            if not part:
                raise SandboxError("the sandbox's process ended unexpectedly")
            data += part
        return data


class Confined:
    """A process that waits. It becomes a run by `begin`, or is ended by `discard`; one of them is called once.

    Attributes:
        limits: what it was confined to.
    """

    def __init__(self, zygote: Zygote, limits: Limits, *, count_threads: bool, prove: bool = False) -> None:
        """Fork it and wait until it has confined itself.

        Args:
            zygote: forks it, and reaps it in the end.
            limits: what to confine it to.
            count_threads: let the kernel count its threads, which needs a user id that nobody else has.
            prove: look for ways out of the jail instead of waiting (see `inside`).

        Raises:
            SandboxError: it could not be forked or confined.
        """
        self.limits = limits
        self._zygote = zygote
        with ExitStack() as undo:
            self._channel, theirs = _socket.socketpair(_socket.AF_UNIX, _socket.SOCK_STREAM)
            undo.callback(self._channel.close)
            with ExitStack() as handed_on:
                handed_on.callback(theirs.close)
                self._captures, writers = _pipes(undo, limits.output_bytes)
                for writer in writers:
                    handed_on.callback(os.close, writer)
                self._pid, pidfd = zygote.fork(
                    (limits.cpu_s, limits.memory_bytes, limits.threads if count_threads else None),
                    (theirs.fileno(), *writers),
                    prove=prove,
                )
            self._process = ProcessHandle(self._pid, pidfd)
            undo.callback(self._process.close)
            _await_start(self._channel, _CONFINE_LIMIT_S)
            self._undo = undo.pop_all()

    def waits(self) -> bool:
        """Return whether it still runs and, as it must, has sent nothing."""
        try:
            self._channel.recv(1, _socket.MSG_PEEK | _socket.MSG_DONTWAIT)
        except BlockingIOError:
            return True
        except OSError:
            return False
        return False

    def begin(self, ended: Callable[[], None]) -> Jail:
        """Return the run; its clocks start now. `ended` is called when it is over."""

        def reap() -> tuple[int, int, int]:
            ended()
            return self._zygote.reap(self._pid)

        return Jail(self._channel, self._process, self._captures, self.limits, reap)

    def discard(self) -> None:
        """End the process, reap it and close its descriptors."""
        with self._undo, suppress(SandboxError):  # a zygote that is gone has taken it along
            self._process.kill()
            self._zygote.reap(self._pid)


def _pipes(undo: ExitStack, limit_bytes: int) -> tuple[tuple[Capture, Capture], tuple[int, int]]:
    """Return captures of two new pipes, to be closed by `undo`, and the pipes' writing ends."""
    stdout, stdout_writer = os.pipe()
    stderr, stderr_writer = os.pipe()
    captures = Capture(stdout, limit_bytes), Capture(stderr, limit_bytes)
    for capture in captures:
        undo.callback(capture.close)
    return captures, (stdout_writer, stderr_writer)


def _await_start(channel: _socket.socket, timeout_s: float) -> None:
    """Wait for the confined process to say that it is confined.

    Raises SandboxError: it says that a step failed, ends, or says nothing in time.
    """
    channel.settimeout(timeout_s)
    try:
        answer = channel.recv(1)
        if answer == b"+":
            return
        reason = channel.recv(4096).decode(errors="replace") if answer == b"-" else "it ended early"
    except OSError as error:
        reason = str(error)
    finally:
        channel.settimeout(None)
    raise _failed(f"the process could not be confined: {reason}")


def _failed(message: str) -> SandboxError:
    return NoRoomError(message) if lacks_room(message) else SandboxError(message)


# --------------------------------------------------------------------------------------- the interpreter


class Interpreter:
    """A started interpreter that waits for its configuration.

    Attributes:
        pid: our child, in a session of its own.
        control: our end of the socket it obeys.
    """

    def __init__(self, pid: int, control: _socket.socket) -> None:
        self.pid = pid
        self.control = control
        self._ended = False

    @property
    def alive(self) -> bool:
        """Whether it still runs; once it does not, it is reaped."""
        self._ended = self._ended or os.waitpid(self.pid, os.WNOHANG)[0] != 0
        return not self._ended

    def kill(self) -> None:
        """Send SIGKILL, unless it has ended."""
        if self.alive:
            os.kill(self.pid, signal.SIGKILL)

    def end(self) -> None:
        """Close the socket, kill the process and reap it."""
        self.control.close()
        self.kill()
        self.wait()

    def wait(self) -> None:
        """Wait for its end."""
        if not self._ended:
            os.waitpid(self.pid, 0)
            self._ended = True


def start_interpreter() -> Interpreter:
    """Start the interpreter with almost no environment.

    ``-P -s -S`` with the fixed environment isolate as ``-I -S`` does; ``-I`` would ignore PYTHONHASHSEED.

    Raises OSError: it could not be started.
    """
    executable = os.path.realpath(sys.executable)
    ours, theirs = _socket.socketpair(_socket.AF_UNIX, _socket.SOCK_STREAM)
    control = theirs.fileno()
    command = [executable, *SAFE_PATH, "-s", "-S", "-X", "utf8", "-c", _BOOTSTRAP, _LAUNCHER, str(control)]
    try:
        with _FixedAddresses():
            pid = os.posix_spawn(
                executable,
                command,
                bounds.ENVIRONMENT,
                file_actions=[
                    (os.POSIX_SPAWN_OPEN, 0, os.devnull, os.O_RDONLY, 0),
                    (os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0),
                    (os.POSIX_SPAWN_DUP2, control, control),  # onto itself: handed on to this child alone
                ],
                setsid=True,
            )
    except OSError:
        ours.close()
        raise
    finally:
        theirs.close()
    if niceness := os.getpriority(os.PRIO_PROCESS, 0):  # a new session does not inherit it
        yield_session(pid, niceness)
    return Interpreter(pid, ours)


def yield_session(pid: int, niceness: int) -> None:
    """Give every other session precedence over the one that process `pid` has begun.

    Where the kernel groups processes by session (autogroup), a process's own niceness counts only inside its
    session (sched(7)). Without privileges the kernel accepts one such request per tenth of a second on the whole
    machine, so processes that start together must try again for a while.
    """
    for _ in range(_AUTOGROUP_TRIES):
        try:
            with open(f"/proc/{pid}/autogroup", "w", encoding="ascii") as file:
                file.write(str(niceness))
            return
        except BlockingIOError:
            time.sleep(_AUTOGROUP_PAUSE_S)
        except OSError:
            return  # this kernel does not group


class _FixedAddresses:
    """Switch address randomisation off for processes started inside, as far as the host allows.

    ``<object at 0x7f...>`` in a script's output, and the order of sets of objects, are then the same in
    every run. This gives up no boundary: the script may read its own memory anyway, and what keeps it in
    is enforced by the kernel. Ordinary containers refuse the call; then addresses differ between zygotes.
    """

    def __enter__(self) -> None:
        self._former: int | None = None
        try:
            former = libc.personality(libc.PERSONALITY_QUERY)
            libc.personality(former | libc.ADDR_NO_RANDOMIZE)
            self._former = former
        except (OSError, AttributeError):
            return

    def __exit__(self, *_: object) -> None:
        if self._former is not None:
            libc.personality(self._former)
