"""What follows ``--ros-args`` on a command line: remapping, parameters, log levels."""

from __future__ import annotations

from rclpy._rcl.errors import RCLError, RCLInvalidROSArgsError, UnknownROSArgsError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from typing import Any

_LEVELS = {"DEBUG": 10, "INFO": 20, "WARN": 30, "ERROR": 40, "FATAL": 50}
_SWITCHES = frozenset(
    f"--{verb}-{what}"
    for verb in ("enable", "disable")
    for what in ("rosout-logs", "stdout-logs", "external-lib-logs")
)


class Remap:
    """One rule ``[node:][scheme]from:=to``; `kind` is ``node``, ``ns``, ``topic``, ``service`` or ``any``."""

    __slots__ = ("kind", "match", "node", "replacement")

    def __init__(self, node: str | None, kind: str, match: str, replacement: str) -> None:
        self.node = node
        self.kind = kind
        self.match = match
        self.replacement = replacement


class RosArgs:
    """Parsed ROS arguments.

    Attributes:
        remaps: rules in order; the first that matches wins.
        parameters: values by pattern of node names, in order of first mention; later patterns win.
        levels: log levels by logger name. rosout: whether logs go to /rosout.
        other: arguments that are not for ROS.
    """

    def __init__(self) -> None:
        self.remaps: list[Remap] = []
        self.parameters: dict[str, dict[str, Any]] = {}
        self.levels: dict[str, int] = {}
        self.rosout = True
        self.unknown: list[str] = []
        self.other: list[str] = []

    def set_parameter(self, pattern: str, name: str, value: Any) -> None:
        """Note a parameter's value for the nodes that match `pattern`."""
        self.parameters.setdefault(pattern, {})[name] = value


def parse_ros_args(args: Sequence[str], *, reject_unknown: bool, of_node: bool = False) -> RosArgs:
    """Parse a command line.

    Args:
        args: the whole command line; ROS arguments stand between ``--ros-args`` and ``--``.
        reject_unknown: whether an unknown ROS argument is an error.
        of_node: the arguments of one node, which are ROS arguments from the start.

    Raises:
        UnknownROSArgsError: an argument is not a ROS argument.
        RCLInvalidROSArgsError: a node's argument cannot be parsed; RCLError for a context's.
        UnicodeEncodeError: an argument is not valid UTF-8.
    """
    for arg in args:
        arg.encode()
    if not of_node and "--ros-args" not in args:
        parsed = RosArgs()
        parsed.other = list(args)
        return parsed
    parsed = RosArgs()
    try:
        _parse_all(list(args), parsed)
    except ValueError as fault:
        text = f"{fault}, at ./src/rcl/arguments.c:343"
        if of_node:
            raise RCLInvalidROSArgsError(f"Failed to parse ROS arguments: {text}") from None
        raise RCLError(f"failed to initialize rcl: {text}") from None
    if parsed.unknown and reject_unknown:
        raise UnknownROSArgsError(f"Found unknown ROS args: {parsed.unknown!r}")
    return parsed


def remove_ros_args(args: Sequence[str]) -> list[str]:
    """Return the arguments that are not for ROS."""
    return parse_ros_args(args, reject_unknown=False).other


def _parse_all(args: list[str], parsed: RosArgs) -> None:
    inside = False
    rest = iter(args)
    for arg in rest:
        if not inside:
            inside = arg == "--ros-args"
            if not inside:
                parsed.other.append(arg)
        elif arg == "--":
            inside = False
        elif arg != "--ros-args":
            _parse_one(arg, rest, parsed)


def _parse_one(arg: str, rest: Any, parsed: RosArgs) -> None:
    handler = _FLAGS.get(arg)
    if handler is not None:
        value = next(rest, None)
        if value is None:
            raise ValueError(f"Couldn't parse trailing {arg} flag. No value provided.")
        handler(arg, value, parsed)
    elif arg in _SWITCHES:
        if arg.endswith("rosout-logs"):
            parsed.rosout = arg.startswith("--enable")
    elif ":=" in arg and not arg.startswith("-"):
        _add_remap("-r", arg, parsed)
    else:
        parsed.unknown.append(arg)


def _add_remap(flag: str, rule: str, parsed: RosArgs) -> None:
    left, separator, replacement = rule.partition(":=")
    if not separator or not left or not replacement:
        raise ValueError(
            f"Couldn't parse remap rule: '{flag} {rule}'. Error: Expected lexeme type (19) not found, "
            f"search ended at index {len(rule)}, at ./src/rcl/lexer_lookahead.c:238"
        )
    node: str | None = None
    kind = "any"
    for scheme, meaning in (("rostopic://", "topic"), ("rosservice://", "service")):
        before, found, after = left.partition(scheme)
        if found:
            node, left, kind = before.rstrip(":") or None, after, meaning
    if kind == "any" and ":" in left:
        node, _, left = left.partition(":")
    if left in ("__node", "__name"):
        kind = "node"
    elif left == "__ns":
        kind = "ns"
    parsed.remaps.append(Remap(node, kind, left, replacement))


def _add_parameter(flag: str, rule: str, parsed: RosArgs) -> None:
    from rclpy._rcl.yaml import parse_value

    left, separator, text = rule.partition(":=")
    if not separator or not left:
        raise ValueError(f"Couldn't parse parameter override rule: '{flag} {rule}'. Error: Expected ':='")
    node, colon, name = left.rpartition(":")
    pattern = ("/" + node.lstrip("/")) if colon else "/**"
    try:
        value = parse_value(text)
    except ValueError as fault:
        raise ValueError(f"Couldn't parse parameter override rule: '{flag} {rule}'. Error: {fault}") from None
    parsed.set_parameter(pattern, name, value)


def _add_file(flag: str, path: str, parsed: RosArgs) -> None:
    from rclpy._rcl.yaml import parse_document

    try:
        with open(path, encoding="utf-8") as file:
            document = parse_document(file.read())
    except (OSError, ValueError) as fault:
        raise ValueError(
            f"Couldn't parse params file: '{flag} {path}'. Error: Error opening YAML file"
            if isinstance(fault, OSError)
            else f"Couldn't parse params file: '{flag} {path}'. Error: {fault}"
        ) from None
    _walk_nodes(document, "", parsed)


def _walk_nodes(mapping: dict[str, Any], path: str, parsed: RosArgs) -> None:
    for key, value in mapping.items():
        if key == "ros__parameters":
            _walk_parameters(value, "", path, parsed)
        elif isinstance(value, dict):
            _walk_nodes(value, path.rstrip("/") + "/" + key.lstrip("/"), parsed)


def _walk_parameters(mapping: dict[str, Any], prefix: str, pattern: str, parsed: RosArgs) -> None:
    parsed.parameters.setdefault(pattern, {})
    for key, value in mapping.items():
        if isinstance(value, dict):
            _walk_parameters(value, f"{prefix}{key}.", pattern, parsed)
        else:
            parsed.set_parameter(pattern, prefix + key, value)


def _add_level(flag: str, rule: str, parsed: RosArgs) -> None:
    name, _, level = rule.rpartition(":=")
    if level.upper() not in _LEVELS:
        raise ValueError(
            f"Couldn't parse log level: '{flag} {rule}'. Error: Argument does not use a valid severity level"
        )
    parsed.levels[name] = _LEVELS[level.upper()]


def _accept(flag: str, value: str, parsed: RosArgs) -> None:
    """Take an option that has no effect here (security enclave, log configuration)."""


_FLAGS: dict[str, Callable[[str, str, RosArgs], None]] = {
    "-r": _add_remap,
    "--remap": _add_remap,
    "-p": _add_parameter,
    "--param": _add_parameter,
    "--params-file": _add_file,
    "--log-level": _add_level,
    "-e": _accept,
    "--enclave": _accept,
    "--log-config-file": _accept,
}
