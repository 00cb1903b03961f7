"""Console logging and /rosout: what rcutils and rcl's logging_rosout do.

Lines go to the process's stderr, not to `sys.stderr`, as upstream's C code writes them.
"""

from __future__ import annotations

import os
import struct

from rclpy._kernel import kernel
from rclpy._link import link
from rclpy._patches.output import budget

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Protocol

    class LogPublisher(Protocol):
        """What logging needs of the publisher of a node's records."""

        def destroy_when_not_in_use(self) -> None:
            """Destroy it."""

        def context_valid(self) -> bool:
            """Whether publishing is possible."""

        def send(self, data: bytes) -> None:
            """Deliver a serialised record."""


NAMES = {10: "DEBUG", 20: "INFO", 30: "WARN", 40: "ERROR", 50: "FATAL"}
INFO, WARN = 20, 30
FORMAT = "[{severity}] [{time}] [{name}]: {message}"
ROSOUT_BYTES = 8_192
"""Longest text a record on /rosout carries: a frame of the channel is bounded."""

_COLOURS = {10: "\033[32m", 20: "\033[0m", 30: "\033[33m", 40: "\033[31m", 50: "\033[31m"}


class _Settings:
    """What the environment says, read when logging starts."""

    def __init__(self) -> None:
        environment = os.environ
        self.format = environment.get("RCUTILS_CONSOLE_OUTPUT_FORMAT") or FORMAT
        self.coloured = environment.get("RCUTILS_COLORIZED_OUTPUT") == "1"
        self.fd = 1 if environment.get("RCUTILS_LOGGING_USE_STDOUT") == "1" else 2


_settings: _Settings | None = None
_levels: dict[str, int] = {}
_rosout: dict[str, LogPublisher] = {}
_rosout_open = False
_nodes: dict[str, str] = {}
"""Logger -> path of its node, which may be gone."""
_late: dict[str, int] = {}
"""Path of a node -> id on the link of what carries its records when no publisher does (`_tell_apart`)."""


def configure(levels: dict[str, int], *, rosout: bool) -> None:
    """Begin logging for a context with the levels of its command line."""
    global _settings, _rosout_open
    _settings = _settings or _Settings()
    _rosout_open = rosout
    for name, level in levels.items():
        _levels[name] = level


def finish() -> None:
    """End logging to /rosout: the last context was shut down. Its publishers go, as in rcl_logging_rosout_fini."""
    global _rosout_open
    _rosout_open = False
    for name in tuple(_rosout):
        close_rosout(name)


def reset() -> None:
    """Forget levels and settings, as rcutils' shutdown does."""
    global _settings
    _settings = None
    _levels.clear()


def set_level(name: str, level: int) -> None:
    """Set the level of a logger; 0 makes it follow its parents; the empty name is the root."""
    if level or not name:
        _levels[name] = level
    else:
        _levels.pop(name, None)


def effective_level(name: str) -> int:
    """Return the level of a logger or of its nearest parent that has one."""
    while name:
        level = _levels.get(name)
        if level:
            return level
        name = name.rpartition(".")[0]
    return _levels.get("", INFO)


def own_level(name: str) -> int:
    """Return the level that was set for a logger; 0 when none was."""
    return _levels.get(name, 0 if name else INFO)


def is_enabled(name: str, severity: int) -> bool:
    """Whether a message of that severity would be shown."""
    if not _levels:
        return severity >= INFO
    return severity >= effective_level(name)


def log(severity: int, name: str, message: str | bytes | None, function: str, file: str, line: int) -> None:
    """Write one line to the console and publish it on the node's /rosout.

    None becomes a null pointer on its way to C, which prints it as ``(null)``. (rclpy's _rclpy_logging.cpp:126)

    Raises TypeError: the message is no text, with the text of upstream's C binding.
    """
    if message is None:
        message = "(null)"
    if isinstance(message, bytes):
        message = message.decode("utf-8", "replace")
    if not isinstance(message, str):
        raise TypeError(
            "rclpy_logging_rcutils_log(): incompatible function arguments. "
            "The following argument types are supported:\n"
            "    1. (arg0: int, arg1: str, arg2: str, arg3: str, arg4: str, arg5: int) -> None\n\n"
            f"Invoked with: {severity!r}, {name!r}, {message!r}, {function!r}, {file!r}, {line}"
        )
    message = message.partition("\0")[0]  # where a text ends in C
    stamp_ns = kernel.epoch_ns + kernel.now_ns
    _print(int(severity), name, message, stamp_ns, (function, file, line))
    if name in _nodes or _is_child(name):
        _publish(name, _record(stamp_ns, int(severity), name, message, (function, file, line)))


def warn(name: str, message: str) -> None:
    """Log a warning of rcl's own."""
    if is_enabled(name, WARN):
        log(WARN, name, message, "", "", 0)


def _print(severity: int, name: str, message: str, stamp_ns: int, place: tuple[str, str, int]) -> None:
    global _settings
    settings = _settings
    if settings is None:
        settings = _settings = _Settings()
    seconds, nanoseconds = divmod(stamp_ns, 1_000_000_000)
    if settings.format is FORMAT:
        text = f"[{NAMES[severity]}] [{seconds}.{nanoseconds:09d}] [{name}]: {message}\n"
    else:
        text = _formatted(settings.format, severity, name, message, stamp_ns, place) + "\n"
    if settings.coloured:
        text = f"{_COLOURS[severity]}{text[:-1]}\033[0m\n"
    write(text, settings.fd)


def _formatted(
    pattern: str, severity: int, name: str, message: str, stamp_ns: int, place: tuple[str, str, int]
) -> str:
    values = {
        "severity": NAMES[severity],
        "time": f"{stamp_ns // 1_000_000_000}.{stamp_ns % 1_000_000_000:09d}",
        "time_as_nanoseconds": f"{stamp_ns:019d}",
        "name": name,
        "function_name": place[0],
        "file_name": place[1],
        "line_number": str(place[2]),
        "message": message,
    }
    pieces = pattern.replace("\\n", "\n").replace("\\t", "\t").split("{")
    text = pieces[0]
    for piece in pieces[1:]:
        key, brace, rest = piece.partition("}")
        text += values[key] + rest if brace and key in values else "{" + piece
    return text


def write(text: str, fd: int = 2) -> None:
    """Write text to a file descriptor of the process; a closed one loses it."""
    data = text.encode("utf-8", "backslashreplace")
    try:
        while data:
            data = data[budget.write(fd, data) :]
    except OSError:
        return


# /rosout -------------------------------------------------------------------------------------------


def attach_rosout(name: str, node: str, publisher: LogPublisher) -> None:
    """Have the logger of that name, which is that of the node at path `node`, publish on `publisher`."""
    _rosout[name] = publisher
    _nodes[name] = node


def know_node(name: str, node: str) -> None:
    """Note that the logger of that name is that of the node at path `node`, which publishes no logs."""
    _nodes.setdefault(name, node)


def _is_child(name: str) -> bool:
    """Whether a logger descends from a node's; what it logs is on the console, and on Humble on no /rosout."""
    parent = name.rpartition(".")[0]
    while parent and parent not in _nodes:
        parent = parent.rpartition(".")[0]
    if not parent or len(_nodes) >= _MOST_LOGGERS:
        return False
    _nodes[name] = _nodes[parent]
    return True


_MOST_LOGGERS = 1_000


def adopt(name: str, parent: str) -> bool:
    """Have a logger publish where `parent` does; whether that publishes."""
    if parent not in _rosout:
        return False
    _rosout[name] = _rosout[parent]
    _nodes[name] = _nodes[parent]
    return True


def disown(name: str) -> None:
    """Undo `adopt`."""
    _rosout.pop(name, None)
    _nodes.pop(name, None)


def has_rosout(name: str) -> bool:
    """Whether the logger of that name publishes."""
    return name in _rosout


def is_rosout_open() -> bool:
    """Whether nodes get log publishers: not with ``--disable-rosout-logs``."""
    return _rosout_open


def close_rosout(name: str) -> None:
    """Destroy the publisher of the logger of that name, if it has one, and of those that were adopted to it."""
    publisher = _rosout.pop(name, None)
    if publisher is not None:
        for child in [child for child, theirs in _rosout.items() if theirs is publisher]:
            del _rosout[child]
        publisher.destroy_when_not_in_use()


def _publish(name: str, record: bytes) -> None:
    """Publish a record on /rosout, or else tell only the episode: the report shows all that a node has logged."""
    publisher = _rosout.get(name)
    if publisher is not None and publisher.context_valid():
        publisher.send(record)
        return
    if publisher is not None:
        from rclpy._rcl.errors import PUBLISHER_CONTEXT

        write(f"Failed to publish log message to rosout: {PUBLISHER_CONTEXT}\n")
    _tell_apart(name, record)


def _tell_apart(name: str, record: bytes) -> None:
    """Send the episode a record that does not reach /rosout: it is on the console, so the report must have it."""
    node = _nodes[name]
    if node not in _late:
        try:
            _late[node] = link.register("publisher", node, "/rosout", "rcl_interfaces/msg/Log")
        except RuntimeError:
            return  # the script has used up all entities
    link.publish(_late[node], record)


_HEAD = struct.Struct("<iIB3x")
_LENGTH = struct.Struct("<I")


def _text(text: str) -> bytes:
    data = text.encode("utf-8", "replace")[:ROSOUT_BYTES]
    return _LENGTH.pack(len(data) + 1) + data + b"\0" * (4 - len(data) % 4)


def _record(stamp_ns: int, level: int, name: str, message: str, place: tuple[Any, Any, Any]) -> bytes:
    """Return an rcl_interfaces/msg/Log as CDR, without the cost of building the message."""
    function, file, line = place
    seconds, nanoseconds = divmod(stamp_ns, 1_000_000_000)
    return (
        b"\0\1\0\0"
        + _HEAD.pack(seconds, nanoseconds, level)
        + _text(name)
        + _text(message)
        + _text(file)
        + _text(function)
        + _LENGTH.pack(line)
    )


# Questions of rclpy.logging --------------------------------------------------------------------------


def initialize() -> None:
    """Read the environment again."""
    global _settings
    _settings = _Settings()


def severity_of(name: str) -> int:
    """Return the number of a severity by its name in any case.

    Raises RuntimeError: there is no such severity. ValueError: `name` is no text.
    """
    if not isinstance(name, str):
        raise ValueError("Log severity must be a string")
    for number, known in ((0, "UNSET"), *NAMES.items()):
        if known == name.upper():
            return number
    raise RuntimeError("Failed to get severity name")


def directory() -> str:
    """Return the directory of log files by rcl_logging's rules (ROS_LOG_DIR, ROS_HOME, ~/.ros)."""
    environment = os.environ
    home = os.path.expanduser("~")
    chosen = environment.get("ROS_LOG_DIR")
    if not chosen:
        chosen = os.path.join(environment.get("ROS_HOME") or os.path.join(home, ".ros"), "log")
    return os.path.normpath(chosen.replace("~", home, 1) if chosen.startswith("~") else chosen)
