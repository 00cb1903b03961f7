"""A look at the jail from inside: what a confined process tries in order to prove that it is confined.

Run by the zygote in a confined process instead of a script. Every attempt is harmless when it succeeds.
Standard library only.
"""

import _socket
import ctypes
import fcntl
import json
import os
import resource
import signal
from collections.abc import Callable, Iterator
from typing import Final

_libc = ctypes.CDLL(None, use_errno=True)
_LOOKED_AT_FDS: Final = 256


def report(channel: int) -> int:
    """Send one frame of JSON over `channel`.

    Its keys: ``breaches`` (attempts that succeeded, as ``layer: what``), ``uid``, ``descriptors``,
    ``environment``, ``limits`` (number -> soft limit).
    """
    body = json.dumps(
        {
            "breaches": [f"{layer}: {what}" for layer, what, attempt in _attempts() if _succeeds(attempt)],
            "uid": os.getuid(),
            "descriptors": [fd for fd in range(_LOOKED_AT_FDS) if _is_open(fd)],
            "environment": dict(os.environ),
            "limits": {str(name): resource.getrlimit(name)[0] for name in range(resource.RLIMIT_AS + 1)},
        }
    ).encode()
    os.write(channel, len(body).to_bytes(4, "little") + body)
    return 0


def _attempts() -> Iterator[tuple[str, str, Callable[[], object]]]:
    parent = os.getppid()
    yield "landlock", "read /etc/passwd", lambda: open("/etc/passwd", "rb").close()
    yield "landlock", "read the grader's code", lambda: open(__file__, "rb").close()
    yield "landlock", "list /", lambda: os.listdir("/")
    yield "landlock", "create a file in /tmp", lambda: os.close(os.open("/tmp", os.O_TMPFILE | os.O_RDWR))  # noqa: S108
    yield "landlock", "open a device for writing", lambda: os.close(os.open("/dev/zero", os.O_RDWR))
    yield "seccomp", "open a network socket", _network_socket
    yield "seccomp", "start a process", _fork
    yield "seccomp", "signal another process", lambda: os.kill(parent, 0)
    yield "seccomp", "read another process's limits", lambda: resource.prlimit(parent, resource.RLIMIT_CPU)
    yield "seccomp", "change a file's mode", lambda: os.fchmod(1, 0o600)
    yield "seccomp", "create memory outside the limits", lambda: os.close(os.memfd_create("probe"))
    yield "seccomp", "read a process's memory", lambda: _call("process_vm_readv", os.getpid(), 0, 0, 0, 0, 0)
    yield "seccomp", "leave a namespace", lambda: _call("unshare", 0x0400_0000)
    yield "seccomp", "create System V shared memory", _shared_memory
    yield "rlimits", "write a core file", lambda: _unless(resource.getrlimit(resource.RLIMIT_CORE) == (0, 0))
    yield "rlimits", "allocate without bound", lambda: bytearray(1 << 40)
    yield "rlimits", "raise a limit", lambda: resource.setrlimit(resource.RLIMIT_CORE, (4096, 4096))


def _succeeds(attempt: Callable[[], object]) -> bool:
    try:
        attempt()
    except (OSError, ValueError, MemoryError):
        return False
    return True


def _unless(held: bool) -> None:
    if held:
        raise PermissionError


def _network_socket() -> None:
    _socket.socket(_socket.AF_INET, _socket.SOCK_DGRAM).close()


def _fork() -> None:
    pid = os.fork()
    if pid == 0:
        os.kill(os.getpid(), signal.SIGKILL)
        os._exit(0)
    os.waitpid(pid, 0)


def _shared_memory() -> None:
    ipc_private, ipc_rmid = 0, 0
    identifier = _call("shmget", ipc_private, 4096, 0o600)
    _call("shmctl", identifier, ipc_rmid, 0)


def _call(name: str, *arguments: int) -> int:
    result = int(getattr(_libc, name)(*(ctypes.c_long(a) for a in arguments)))
    if result < 0:
        number = ctypes.get_errno()
        raise OSError(number, os.strerror(number))
    return result


def _is_open(descriptor: int) -> bool:
    try:
        fcntl.fcntl(descriptor, fcntl.F_GETFD)
    except OSError:
        return False
    return True
