"""A confined process up to its first frame: forked by a zygote, confined, and waiting to be told what to run."""

import _socket
import os
from collections.abc import Callable
from contextlib import ExitStack, suppress
from typing import Final

from grader.contracts.errors import SandboxError
from grader.contracts.limits import Limits
from grader.jail.jail import Jail
from grader.jail.process import ProcessHandle
from grader.jail.streams import Capture
from grader.jail.supervisor import Zygote

_CONFINE_LIMIT_S: Final = 20.0


class Confined:
    """A process that waits. It becomes a run by `begin`, or is ended by `discard`; one of them is called once.

    Attributes:
        limits: what it was confined to.
    """

    def __init__(self, zygote: Zygote, limits: Limits, *, count_threads: bool, prove: bool = False) -> None:
        """Fork it and wait until it has confined itself.

        Args:
            zygote: what forks it, and reaps it in the end.
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
        """Return whether it is still there, as silent as it has to be."""
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
        """End the process, reap it and close what belongs to it."""
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

    Raises:
        SandboxError: it says that a step failed, ends, or says nothing in time.
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
    raise SandboxError(f"the process could not be confined: {reason}")
