"""What launch prints about itself: lines on the screen, as launch's loggers write them."""

from __future__ import annotations

import logging as _logging
import os
import sys

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

__all__ = ["get_logger", "launch_config"]

_loggers: dict[str, _logging.Logger] = {}


class _Screen(_logging.Handler):
    def emit(self, record: _logging.LogRecord) -> None:
        sys.stdout.write(f"[{record.levelname}] [{record.name}]: {record.getMessage()}\n")


def get_logger(name: str | None = None) -> _logging.Logger:
    """Return the logger of a name, which prints from INFO on."""
    logger_name = name or "root"
    if logger_name not in _loggers:
        _loggers[logger_name] = _logging.Logger(logger_name, launch_config.level)
        _loggers[logger_name].addHandler(_Screen())
    return _loggers[logger_name]


class LaunchConfig:
    """How launch logs.

    Attributes:
        level: from which on new loggers print. log_dir: the folder of this launch's log files.
    """

    def __init__(self) -> None:
        self.level: Any = _logging.INFO
        self._log_dir = ""

    @property
    def log_dir(self) -> str:
        """The folder of this launch's log files; it is made when it is first asked for."""
        if not self._log_dir:
            from datetime import datetime
            from socket import gethostname

            own = os.path.join(os.environ.get("ROS_HOME") or os.path.join("~", ".ros"), "log")
            base = os.path.normpath(os.path.expanduser(os.environ.get("ROS_LOG_DIR") or own))
            now = datetime.now().strftime("%Y-%m-%d-%H-%M-%S-%f")
            self._log_dir = os.path.join(base, f"{now}-{gethostname()}-{os.getpid()}")
            os.makedirs(self._log_dir, exist_ok=True)
        return self._log_dir

    @log_dir.setter
    def log_dir(self, value: str) -> None:
        self._log_dir = value


launch_config = LaunchConfig()
