"""Arguments behind ``--ros-args`` on a command line: remapping, parameters, log levels."""

from __future__ import annotations

from rclpy._rcl.errors import RCLError, RCLInvalidROSArgsError, UnknownROSArgsError
from rclpy._rcl.rules import read_level_rule, read_parameter_rule, read_remap

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from typing import Any

    from rclpy._rcl.parameter_values import Value
    from rclpy._rcl.rules import Remap

_LEVELS = {"DEBUG": 10, "INFO": 20, "WARN": 30, "ERROR": 40, "FATAL": 50}
_SWITCHES = frozenset(
    f"--{verb}-{what}"
    for verb in ("enable", "disable")
    for what in ("rosout-logs", "stdout-logs", "external-lib-logs")
)


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
        self.parameters: dict[str, dict[str, Value]] = {}
        self.levels: dict[str, int] = {}
        self.rosout = True
        self.unknown: list[str] = []
        self.other: list[str] = []

    def value_of(self, pattern: str, name: str) -> Value:
        """Return what is given for a parameter of the nodes that match `pattern`, to be added to."""
        from rclpy._rcl.parameter_values import Value

        values = self.parameters.setdefault(pattern, {})
        if name not in values:
            values[name] = Value()
        return values[name]


def parse_ros_args(args: Sequence[str], *, reject_unknown: bool, of_node: bool = False) -> RosArgs:
    """Parse a command line.

    Args:
        args: the whole command line; ROS arguments stand between ``--ros-args`` and ``--``.
        reject_unknown: whether an unknown ROS argument is an error.
        of_node: the arguments of one node.

    Raises:
        UnknownROSArgsError: an argument is not a ROS argument.
        RCLInvalidROSArgsError: a node's argument cannot be parsed; RCLError for a context's.
        TypeError: an argument is no text. UnicodeEncodeError: it is not valid UTF-8.
    """
    for arg in args:
        if not isinstance(arg, str):
            raise TypeError("bad argument type for built-in operation")
        arg.encode()
    if not any(arg == "--ros-args" or ":=" in arg for arg in args):
        parsed = RosArgs()
        parsed.other = list(args)
        return parsed
    parsed = RosArgs()
    try:
        _parse_all(list(args), parsed)
    except ValueError as fault:
        if of_node:
            raise RCLInvalidROSArgsError(f"Failed to parse ROS arguments: {fault}") from None
        from rclpy._rcl import logs

        logs.log(40, "rcl", "Failed to parse global arguments", "", "", 0)
        raise RCLError(f"failed to initialize rcl: {fault}") from None
    if parsed.unknown and reject_unknown:
        raise UnknownROSArgsError(repr(parsed.unknown))
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
            if not inside and not _is_old_remap(arg, parsed):
                parsed.other.append(arg)
        elif arg == "--":
            inside = False
        elif arg != "--ros-args":
            _parse_one(arg, rest, parsed)


def _is_old_remap(arg: str, parsed: RosArgs) -> bool:
    """Take a remap rule outside ROS arguments, where the first version of ROS 2 had it."""
    if ":=" not in arg:
        return False
    try:
        parsed.remaps.append(read_remap(arg))
    except ValueError:
        return False
    from rclpy._rcl import logs

    advice = f"This syntax is deprecated. Use '--ros-args --remap {arg}' instead."
    logs.warn("rcl", f"Found remap rule '{arg}'. {advice}")
    return True


def _parse_one(arg: str, rest: Any, parsed: RosArgs) -> None:
    if arg in _FLAGS:
        _parse_flag(arg, next(rest, None), parsed)
    elif arg in _SWITCHES:
        if arg.endswith("rosout-logs"):
            parsed.rosout = arg.startswith("--enable")
    else:
        parsed.unknown.append(arg)


def _parse_flag(flag: str, value: str | None, parsed: RosArgs) -> None:
    """Give a flag's value to its handler; ValueError with rcl's text, which ends in the line of its source."""
    handler, line, what, missing = _FLAGS[flag]
    if value is None:
        at = f"at ./src/rcl/arguments.c:{line + 4}"
        raise ValueError(f"Couldn't parse trailing {missing.format(flag)}, {at}")
    try:
        handler(value, parsed)
    except ValueError as fault:
        text = f"Couldn't parse {what}: '{flag} {value}'. Error: {fault}, at ./src/rcl/arguments.c:{line}"
        raise ValueError(text) from None


def _add_remap(rule: str, parsed: RosArgs) -> None:
    parsed.remaps.append(read_remap(rule))


def _add_parameter(rule: str, parsed: RosArgs) -> None:
    from rclpy._rcl.parameter_values import read_value

    pattern, name, text = read_parameter_rule(rule)
    read_value(text, parsed.value_of(pattern, name))


def _add_file(path: str, parsed: RosArgs) -> None:
    from rclpy._rcl.parameter_values import read_file

    try:
        with open(path, encoding="utf-8") as file:
            text = file.read()
    except OSError:
        raise ValueError("Error opening YAML file, at ./src/parser.c:270") from None
    read_file(text, parsed.value_of)


def _add_level(rule: str, parsed: RosArgs) -> None:
    name, level = read_level_rule(rule)
    if level.upper() not in _LEVELS:
        text = "Argument does not use a valid severity level"
        raise ValueError(f"{text}, at ./src/rcl/arguments.c:1806")
    parsed.levels[name] = _LEVELS[level.upper()]


def _accept(value: str, parsed: RosArgs) -> None:
    """Take an option that has no effect here (security enclave, log configuration)."""


_PARAMETER = (_add_parameter, 343, "parameter override rule", "{} flag. No parameter override rule found.")
_REMAP = (_add_remap, 371, "remap rule", "{} flag. No remap rule found.")
_ENCLAVE = (_accept, 499, "enclave name", "{} flag. No enclave path provided.")
_FLAGS: dict[str, tuple[Callable[[str, RosArgs], None], int, str, str]] = {
    "-p": _PARAMETER,
    "--param": _PARAMETER,
    "-r": _REMAP,
    "--remap": _REMAP,
    "--params-file": (_add_file, 406, "params file", "{} flag. No file path provided."),
    "--log-level": (_add_level, 432, "log level", "log level flag: '{}'. No log level provided."),
    "--log-config-file": (_accept, 467, "log configuration file", "{} flag. No file path provided."),
    "-e": _ENCLAVE,
    "--enclave": _ENCLAVE,
}
"""Flag -> handler, line of rcl's arguments.c that refuses its value, and what it says of a bad and of no value."""
