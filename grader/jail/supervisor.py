"""The trusted side of a zygote: start it, have it fork and reap, restart it when it is gone."""

import _socket
import array
import json
import threading
from dataclasses import asdict
from pathlib import Path
from typing import Final

from grader.contracts.errors import SandboxError
from grader.contracts.record import record
from grader.jail.spawn import spawn

_ANSWER_LIMIT_S: Final = 20.0
_ANSWER_MAX_BYTES: Final = 1 << 20
FILTER_DIRECTORY: Final = Path(__file__).with_name("filters")


@record
class ZygoteConfig:
    """What a zygote is told once; see `zygote._prepare`. Paths are absolute."""

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
    filters: str = str(FILTER_DIRECTORY)


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
            self._process = spawn()
        except OSError as error:
            raise SandboxError(f"the sandbox's process could not be started: {error}") from error
        self._control = self._process.control
        self._control.settimeout(_ANSWER_LIMIT_S)
        self._request(asdict(config))

    @property
    def alive(self) -> bool:
        """Whether the process is running and has kept to its protocol."""
        return not self._broken and self._process.alive

    def wait_ready(self) -> None:
        """Return once the zygote has prepared itself.

        Raises:
            SandboxError: it could not; the message says which step failed.
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
            raise SandboxError(f"the sandbox's process could not do its part: {answer['error']}")
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
