"""Loggers by name and their levels."""

from __future__ import annotations

from rclpy._rcl import logs
from rclpy.impl.logging_severity import LoggingSeverity as LoggingSeverity
from rclpy.impl.rcutils_logger import RcutilsLogger

TYPE_CHECKING = False
if TYPE_CHECKING:
    from pathlib import Path

_root_logger = RcutilsLogger()


def get_logger(name: str) -> RcutilsLogger:
    """Return the logger of a name; ValueError when it is empty."""
    if not name:
        raise ValueError("Logger name must not be empty.")
    return _root_logger.get_child(name)


def initialize() -> None:
    """Begin logging (done by itself)."""
    logs.initialize()


def shutdown() -> None:
    """End logging and forget all levels."""
    logs.reset()


def clear_config() -> None:
    """Forget all levels."""
    shutdown()
    initialize()


def set_logger_level(name: str, level: int) -> None:
    """Set the least severity a logger shows; the empty name is the root."""
    logs.set_level(name, LoggingSeverity(level))


def get_logger_effective_level(name: str) -> LoggingSeverity:
    """Return the least severity a logger shows."""
    return LoggingSeverity(logs.effective_level(name))


def get_logging_severity_from_string(log_severity: str) -> LoggingSeverity:
    """Return the severity of a name in any case; RuntimeError for an unknown one."""
    return LoggingSeverity(logs.severity_of(log_severity))


def get_logging_directory() -> Path:
    """Return the directory log files would be written to."""
    from pathlib import Path

    return Path(logs.directory())
