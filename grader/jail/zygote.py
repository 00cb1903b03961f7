"""The warm process that every student process is forked from.

It is started with an almost empty environment, never sees a submission's text, a check or a secret, and
holds nothing but the interpreter and the shim. It obeys its supervisor over one stream socket (its
descriptor is named in argv): length-prefixed JSON both ways, descriptors as ancillary data.

| request | answer |
|---|---|
| the configuration, once | ``{"ready": true, "namespaces": bool}`` or ``{"error": text}`` |
| ``{"do": "fork", "budget": [...], "prove": bool}``, 3 descriptors | ``{"pid": n}``, pidfd, or an error |
| ``{"do": "reap", "pid": n}`` | ``{"status": n, "cpu_ns": n, "peak_bytes": n}`` |

A forked process confines itself, says so with one byte on its channel (``+``, or ``-`` and a sentence), and
calls the entry point; with ``prove`` it looks for ways out instead (`inside`). Standard library only.
"""

import _socket
import _thread
import array
import fcntl
import gc
import importlib
import json
import os
import resource
import signal
import sys
from collections.abc import Callable
from contextlib import suppress
from importlib.machinery import ModuleSpec
from importlib.util import spec_from_file_location
from io import TextIOWrapper
from typing import Any, NoReturn

from . import bounds, inside, landlock, libc, namespaces, syscalls
from .confine import Budget, Layers, confine

_LENGTH_BYTES = 4
_FDS_PER_FORK = 3
_FIRST_FREE_FD = bounds.CHANNEL_FD + 1
_NUMBER_OF_FILES = 128  # more than it ever opens, and below the 256 descriptors that `confine` closes
_BLOCKS_PER_SIZE = 48  # more than a request takes of any size
_BYTES_PER_SIZE = range(15, 480, 16)
"""Lengths of `bytes` that take one block of each size of Python's allocator: 48 to 512 bytes with their header.
Larger blocks come from the C library."""

_own_modules: list[str] = []

Entry = Callable[[int], object]
Json = dict[str, Any]
"""A message of the trusted supervisor, or one to it."""


def main() -> None:
    """Serve the supervisor until it goes away."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl+C is for the supervisor, which then ends this process
    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(_NUMBER_OF_FILES, hard), hard))
    control = _socket.socket(_socket.AF_UNIX, _socket.SOCK_STREAM, 0, int(sys.argv.pop()))
    with suppress(EOFError, ConnectionError):  # the supervisor is gone
        _answer_all(control)


def _answer_all(control: _socket.socket) -> None:
    request, _ = _receive(control)
    try:
        layers, entry = _prepare(request)
    except Exception as error:  # whatever it is, only the supervisor can report it
        _send(control, {"error": f"{type(error).__name__}: {error}"})
        return
    _send(control, {"ready": True, "namespaces": layers.namespaces})
    _serve(control, layers, entry)


def _serve(control: _socket.socket, layers: Layers, entry: Entry) -> None:
    while True:
        _serve_one(control, layers, entry)


def _serve_one(control: _socket.socket, layers: Layers, entry: Entry) -> None:
    """Obey one request.

    A function of its own, so that its locals are freed before the next request comes: what a child creates must
    not lie at other addresses because of the request before (see `_take_up_gaps`).
    """
    request, descriptors = _receive(control)
    if request["do"] == "reap":
        _send(control, _reap(request["pid"]))
        return
    try:
        pid = os.fork()
    except OSError as error:
        _send(control, {"error": str(error)})
        pid = -1
    if pid == 0:
        start = inside.report if request["prove"] else entry
        _become_student(layers, Budget(*request["budget"]), start, descriptors)
    if pid > 0:
        _announce(control, pid)
    for descriptor in descriptors:
        os.close(descriptor)


def _announce(control: _socket.socket, pid: int) -> None:
    if not hasattr(os, "pidfd_open"):
        _send(control, {"pid": pid})
        return
    pidfd = os.pidfd_open(pid)
    _send(control, {"pid": pid}, pidfd)
    os.close(pidfd)


def _reap(pid: int) -> Json:
    status, cpu_ns, peak = libc.wait(pid)
    peak_unit_bytes = 1 if sys.platform == "darwin" else 1024
    return {"status": status, "cpu_ns": cpu_ns, "peak_bytes": peak * peak_unit_bytes}


# -------------------------------------------------------------------------------------------- preparation


def _prepare(config: Json) -> tuple[Layers, Entry]:
    """Preload what scripts need and build what confinement needs."""
    program = syscalls.read_filter(directory=config["filters"]) if config["seccomp"] else None
    _offer_to_oom_killer()
    _drop_launcher()
    sys.path.insert(0, str(config["shim"]))
    _allow_packages(config["packages"])
    module, _, function = str(config["entry"]).partition(":")
    for name in config["preload"]:
        importlib.import_module(name)
    entry: Entry = getattr(importlib.import_module(module), function)
    sys.dont_write_bytecode = True  # what is imported from here on is the student's
    # Only after the imports: the new root cannot be written to, so the shim's byte code would never be kept.
    separate = bool(config["namespaces"]) and namespaces.enter(config["shown"], config["masked"])
    if config["root"] is not None:
        os.chroot(config["root"])
        os.chdir("/")
    if sys.platform == "linux":
        libc.prctl(libc.PR_SET_DUMPABLE, 0)  # nobody of the same user may read its memory or attach to it
    _prime_import_caches()
    _thread.stack_size(bounds.THREAD_STACK_BYTES)
    ruleset = None
    if config["landlock"]:
        readable: list[str] = config["readable"]
        ruleset = landlock.create_ruleset([*readable, *bounds.READABLE_DEVICES], bounds.WRITABLE_DEVICES)
        ruleset = fcntl.fcntl(ruleset, fcntl.F_DUPFD_CLOEXEC, _FIRST_FREE_FD)  # out of the channel's place
    # Each child takes these away, so that a script that lists or imports modules sees what it would see at home.
    # They are looked up here: in a child, a look at the names of all modules would copy the pages they lie on.
    _own_modules.extend(name for name in sys.modules if name.partition(".")[0] == "jail")
    # A collection in a child would touch, and so copy, every page of what all children share.
    gc.collect()
    gc.freeze()
    box_uid: int | None = config["box_uid"]
    return Layers(ruleset, program, box_uid, config["keep_read"] and not separate, separate), entry


def _offer_to_oom_killer() -> None:
    """Make the kernel end a student's process first when the host runs out of memory."""
    try:
        with open("/proc/self/oom_score_adj", "w", encoding="ascii") as file:
            file.write("1000")
    except OSError:
        return


def _drop_launcher() -> None:
    """Take the grader's own directory off the import path: a script must not find the grader's modules there."""
    launcher = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    sys.path[:] = [entry for entry in sys.path if os.path.abspath(entry) != launcher]
    sys.argv[:] = [""]


def _allow_packages(packages: dict[str, str]) -> None:
    """Make `packages` (name -> directory) importable although their parent directory is on no path."""

    class AllowedPackages:
        """Finds the allowed third-party packages, and nothing else next to them."""

        @staticmethod
        def find_spec(name: str, path: object = None, target: object = None) -> ModuleSpec | None:
            directory = packages.get(name)
            if directory is None:
                return None
            return spec_from_file_location(
                name, os.path.join(directory, "__init__.py"), submodule_search_locations=[directory]
            )

    sys.meta_path.append(AllowedPackages)


def _prime_import_caches() -> None:
    """Make the import system read the directories on its path while the process still may.

    A confined process may read the standard library's entries but not list its directory, which on many
    installations holds site-packages too.
    """
    for finder in sys.meta_path:
        finder.find_spec("_no_such_module", None)


# ------------------------------------------------------------------------------------------- student side


def _become_student(layers: Layers, budget: Budget, entry: Entry, descriptors: list[int]) -> NoReturn:
    """Confine this process and run the entry point; never returns."""
    code = 70
    try:
        try:
            confine(layers, budget, *descriptors)
        except BaseException as error:  # no script may run after a step that failed
            _refuse(descriptors[0], error)
        os.write(bounds.CHANNEL_FD, b"+")
        signal.signal(signal.SIGINT, signal.default_int_handler)  # the script's own Ctrl+C works as at home
        # Not reconfigure(): these objects were made for the zygote's null device.
        sys.stdout = sys.__stdout__ = _text_output(1, "strict")  # type: ignore[misc]
        sys.stderr = sys.__stderr__ = _text_output(2, "backslashreplace")  # type: ignore[misc]
        for name in _own_modules:
            del sys.modules[name]
        _kept = _take_up_gaps()
        result = entry(bounds.CHANNEL_FD)
        code = result if isinstance(result, int) else 0
        sys.stdout.flush()
        sys.stderr.flush()
    except BaseException:  # the shim reports what a script raises; only a fault of the shim itself gets here
        sys.excepthook(*sys.exc_info())
    finally:
        os._exit(code)  # never return: this is a copy of the zygote, which would go on to serve requests


def _take_up_gaps() -> list[object]:
    """Return objects that fill the memory which the zygote's requests used and freed.

    Each request leaves the free blocks of a size in a different order. While all of them are taken, what a script
    creates lies at the same addresses in every run, so sets of its objects have the same order, and reports the
    same bytes.
    """
    gc.collect()  # this also empties Python's lists of freed lists, tuples and numbers
    kept: list[object] = []
    for number in range(_BLOCKS_PER_SIZE):
        kept += [object(), number + 0.5, *map(bytes, _BYTES_PER_SIZE)]
    return kept


def _text_output(descriptor: int, errors: str) -> TextIOWrapper:
    """Return a text stream that is flushed at each line, so that a killed script's last words are kept."""
    return open(descriptor, "w", 1, "utf-8", errors, closefd=False)


def _refuse(channel: int, error: BaseException) -> NoReturn:
    message = f"-{type(error).__name__}: {error}".encode(errors="replace")
    for descriptor in (channel, bounds.CHANNEL_FD):
        try:
            os.write(descriptor, message)
            break
        except OSError:
            continue
    os._exit(71)


# ------------------------------------------------------------------------------------------------ control


def _receive(control: _socket.socket) -> tuple[Json, list[int]]:
    """Return the next request and its descriptors; EOFError once the supervisor is gone."""
    room = _socket.CMSG_SPACE(_FDS_PER_FORK * array.array("i").itemsize)
    data, ancillary, _, _ = control.recvmsg(_LENGTH_BYTES, room)
    descriptors = array.array("i")
    for level, kind, payload in ancillary:
        if level == _socket.SOL_SOCKET and kind == _socket.SCM_RIGHTS:
            descriptors.frombytes(payload)
    data += _receive_exactly(control, _LENGTH_BYTES - len(data))
    body = _receive_exactly(control, int.from_bytes(data, "little"))
    # Not list(descriptors): Python keeps freed lists for reuse, one more after each request, and what a child
    # creates would lie at other addresses than in the child before.
    return json.loads(body), descriptors.tolist()


def _receive_exactly(control: _socket.socket, size: int) -> bytes:
    data = b""
    while len(data) < size:
        part = control.recv(size - len(data))
        if not part:
            raise EOFError
        data += part
    return data


def _send(control: _socket.socket, answer: Json, *descriptors: int) -> None:
    body = json.dumps(answer).encode()
    rights = [(_socket.SOL_SOCKET, _socket.SCM_RIGHTS, array.array("i", descriptors))] if descriptors else []
    data = len(body).to_bytes(_LENGTH_BYTES, "little") + body
    sent = control.sendmsg([data], rights)
    if sent < len(data):
        control.sendall(data[sent:])
