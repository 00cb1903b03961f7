"""Levels by name, and child loggers that publish on the /rosout of their node."""

from __future__ import annotations

from rclpy import logging
from rclpy._jazzy.overlay import extends, replace
from rclpy._rcl import logs
from rclpy.impl import rcutils_logger
from rclpy.impl.logging_severity import LoggingSeverity

_humble_child = rcutils_logger.RcutilsLogger.get_child
_children: dict[str, int] = {}
"""Names of loggers below a node's -> how many there are."""


@extends(rcutils_logger.RcutilsLogger)
class RcutilsLogger(rcutils_logger.RcutilsLogger):
    """A logger; what it shows depends on its level or that of its parents."""

    def get_child(self, name: str) -> rcutils_logger.RcutilsLogger:
        """Return the logger ``parent.name``, which publishes where its parent does; ValueError when empty."""
        child = _humble_child(self, name)
        if self.name and logs.adopt(child.name, self.name):
            _children[child.name] = _children.get(child.name, 0) + 1
            child.logger_sublogger_namepair = (self.name, name)  # type: ignore[attr-defined]
        return child

    def __del__(self) -> None:
        if getattr(self, "logger_sublogger_namepair", None) is None:
            return
        _children[self.name] -= 1
        if not _children[self.name]:
            logs.disown(self.name)


def set_logger_level(name: str, level: int, detailed_error: bool = False) -> None:
    """Set the least severity a logger shows; the empty name is the root."""
    logs.set_level(name, LoggingSeverity(level))


def get_logger_level(name: str) -> LoggingSeverity:
    """Return the level that was set for a logger itself; UNSET when none was."""
    return LoggingSeverity(logs.own_level(name))


replace(logging, set_logger_level=set_logger_level, get_logger_level=get_logger_level)
