"""Loggers, with the filters a call site can ask for: once, throttle, skip_first."""

from __future__ import annotations

import sys

from rclpy._rcl import logs
from rclpy.clock import Clock
from rclpy.impl.logging_severity import LoggingSeverity

TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import FrameType
    from typing import Any, ClassVar

_OWN_FILES = (__file__, __file__.replace("impl/rcutils_logger.py", "logging.py"))


class CallerId:
    """Where a logging call stands: function, file, line and instruction."""

    __slots__ = ("file_path", "function_name", "last_index", "line_number")

    def __init__(self, frame: FrameType | None = None) -> None:
        if frame is None:
            frame = _calling_frame()
        self.function_name = frame.f_code.co_name
        self.file_path = frame.f_code.co_filename
        self.line_number = frame.f_lineno
        self.last_index = frame.f_lasti

    def _key(self) -> tuple[str, str, int, int]:
        return self.function_name, self.file_path, self.line_number, self.last_index

    def __eq__(self, other: object) -> bool:
        return isinstance(other, CallerId) and self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())


def _calling_frame() -> FrameType:
    """Return the frame that logs: the innermost one outside of this package's logging."""
    frame = sys._getframe(1)
    while frame.f_code.co_filename in _OWN_FILES and frame.f_back is not None:
        frame = frame.f_back
    return frame


class LoggingFilter:
    """Decides whether a logging call is shown, for each call site by itself.

    `params` maps the keywords of the call that the filter takes to their defaults; None: the keyword is required.
    """

    params: ClassVar[dict[str, Any]] = {}

    @classmethod
    def initialize_context(cls, context: dict[str, Any], **kwargs: Any) -> None:
        """Keep the keywords of the first call in the context of its call site."""
        for name, default in cls.params.items():
            context[name] = kwargs.get(name, default)
            if context[name] is None:
                raise TypeError(
                    f'Required parameter "{name}" was not specified for logging filter "{cls.__name__}"'
                )

    @staticmethod
    def should_log(context: dict[str, Any]) -> bool:
        """Whether this call is logged; updates the context."""
        return True


class Once(LoggingFilter):
    """Log the first call only."""

    params: ClassVar[dict[str, Any]] = {"once": None}

    @classmethod
    def initialize_context(cls, context: dict[str, Any], **kwargs: Any) -> None:
        super().initialize_context(context, **kwargs)
        context["has_been_logged_once"] = False

    @staticmethod
    def should_log(context: dict[str, Any]) -> bool:
        first = not context["has_been_logged_once"]
        context["has_been_logged_once"] = True
        return first


class Throttle(LoggingFilter):
    """Log at most once per period."""

    params: ClassVar[dict[str, Any]] = {"throttle_duration_sec": None, "throttle_time_source_type": Clock()}

    @classmethod
    def initialize_context(cls, context: dict[str, Any], **kwargs: Any) -> None:
        super().initialize_context(context, **kwargs)
        context["throttle_last_logged"] = 0
        if not isinstance(context["throttle_time_source_type"], Clock):
            raise ValueError(
                f'Received throttle_time_source_type of "{context["throttle_time_source_type"]}" '
                "is not a clock instance"
            )

    @staticmethod
    def should_log(context: dict[str, Any]) -> bool:
        now_ns = context["throttle_time_source_type"].now().nanoseconds
        due = bool(now_ns >= context["throttle_last_logged"] + context["throttle_duration_sec"] * 1e9)
        if due:
            context["throttle_last_logged"] = now_ns
        return due


class SkipFirst(LoggingFilter):
    """Log all calls but the first."""

    params: ClassVar[dict[str, Any]] = {"skip_first": None}

    @classmethod
    def initialize_context(cls, context: dict[str, Any], **kwargs: Any) -> None:
        super().initialize_context(context, **kwargs)
        context["first_has_been_skipped"] = False

    @staticmethod
    def should_log(context: dict[str, Any]) -> bool:
        later: bool = context["first_has_been_skipped"]
        context["first_has_been_skipped"] = True
        return later


supported_filters: dict[str, type[LoggingFilter]] = {
    "throttle": Throttle,
    "skip_first": SkipFirst,
    "once": Once,
}


def get_filters_from_kwargs(**kwargs: Any) -> list[str]:
    """Return the filters that the keywords ask for; TypeError for an unknown keyword or a missing required one."""
    parameters = [name for cls in supported_filters.values() for name in cls.params]
    detected = [key for key, cls in supported_filters.items() if any(kwargs.get(name) for name in cls.params)]
    for key in detected:
        for name, default in supported_filters[key].params.items():
            if name not in kwargs and default is None:
                raise TypeError(
                    f'required parameter "{name}" not specified but is required for the '
                    f'the logging filter "{key}"'
                )
    for name in kwargs:
        if name not in parameters:
            raise TypeError(f'parameter "{name}" is not one of the recognized logging options "{parameters}"')
    return detected


_NAMELESS = frozenset({"<lambda>", "<genexpr>", "<listcomp>", "<setcomp>", "<dictcomp>"})
"""Names of functions that may stand several on a line, so that name and first line do not tell them apart."""

_detected: dict[tuple[object, ...], list[str]] = {}
"""What `get_filters_from_kwargs` has returned, by the keywords and whether they are true: nothing else counts."""


def _filters_of(kwargs: dict[str, Any]) -> list[str]:
    asked = (*kwargs, *map(bool, kwargs.values()))
    filters = _detected.get(asked)
    if filters is None:
        filters = _detected[asked] = get_filters_from_kwargs(**kwargs)
    return filters


class RcutilsLogger:
    """A logger; what it shows depends on its level or that of its parents."""

    def __init__(self, name: str = "") -> None:
        self.name = name
        self.contexts: dict[tuple[str, str, int, int], dict[str, Any]] = {}

    def get_child(self, name: str) -> RcutilsLogger:
        """Return the logger ``parent.name``; ValueError when the name is empty."""
        if not name:
            raise ValueError("Child logger name must not be empty.")
        if self.name:
            name = self.name + "." + name
        return RcutilsLogger(name=name)

    def set_level(self, level: int) -> None:
        """Set the least severity shown; ValueError for an unknown one."""
        logs.set_level(self.name, LoggingSeverity(level))

    def get_effective_level(self) -> LoggingSeverity:
        """Return the least severity shown."""
        return LoggingSeverity(logs.effective_level(self.name))

    def is_enabled_for(self, severity: int) -> bool:
        """Whether messages of a severity are shown."""
        return logs.is_enabled(self.name, LoggingSeverity(severity))

    def log(self, message: str, severity: int, **kwargs: Any) -> bool:
        """Log a message.

        Args:
            message: the text.
            severity: a LoggingSeverity.
            kwargs: ``once``, ``skip_first``, ``throttle_duration_sec``, ``throttle_time_source_type``.

        Returns:
            Whether it was shown.

        Raises:
            TypeError: the message is no text, or a keyword is unknown.
            ValueError: the same call site was used with another severity, name or filter before.
        """
        severity = severity if type(severity) is LoggingSeverity else LoggingSeverity(severity)
        if not logs.is_enabled(self.name, severity):
            return False
        name = kwargs.pop("name", self.name)
        filters = _filters_of(kwargs) if kwargs else []
        frame = _calling_frame()
        code = frame.f_code
        # The first line and the instruction imply the line, but not for lambdas. Finding it takes microseconds.
        line = frame.f_lineno if code.co_name in _NAMELESS else code.co_firstlineno
        site = (code.co_filename, code.co_name, line, frame.f_lasti)
        context = self.contexts.get(site)
        if context is None:
            context = {"name": name, "severity": severity, "kwargs": kwargs}
            for key in filters:
                supported_filters[key].initialize_context(context, **kwargs)
            context["filters"] = filters
            self.contexts[site] = context
        elif severity != context["severity"] or name != context["name"] or kwargs != context["kwargs"]:
            _check_unchanged(context, name, severity, filters, kwargs)
        for key in filters:
            if not supported_filters[key].should_log(context):
                return False
        logs.log(severity, name, message, code.co_name, code.co_filename, frame.f_lineno)
        return True

    def debug(self, message: str, **kwargs: Any) -> bool:
        """Log for developers; hidden by default."""
        return self.log(message, LoggingSeverity.DEBUG, **kwargs)

    def info(self, message: str, **kwargs: Any) -> bool:
        """Log what goes as expected."""
        return self.log(message, LoggingSeverity.INFO, **kwargs)

    def warning(self, message: str, **kwargs: Any) -> bool:
        """Log something that may go wrong."""
        return self.log(message, LoggingSeverity.WARN, **kwargs)

    def warn(self, message: str, **kwargs: Any) -> bool:
        """Log as `warning` does."""
        return self.warning(message, **kwargs)

    def error(self, message: str, **kwargs: Any) -> bool:
        """Log something that went wrong."""
        return self.log(message, LoggingSeverity.ERROR, **kwargs)

    def fatal(self, message: str, **kwargs: Any) -> bool:
        """Log something that cannot be recovered from."""
        return self.log(message, LoggingSeverity.FATAL, **kwargs)


def _check_unchanged(
    context: dict[str, Any], name: str, severity: int, filters: list[str], kwargs: dict[str, Any]
) -> None:
    """Raise ValueError unless a call site asks for the same as the first time."""
    if severity != context["severity"]:
        raise ValueError("Logger severity cannot be changed between calls.")
    if name != context["name"]:
        raise ValueError("Logger name cannot be changed between calls.")
    if filters != context["filters"]:
        raise ValueError("Requested logging filters cannot be changed between calls.")
    for key in filters:
        params = supported_filters[key].params
        if any(context[name] != kwargs.get(name, default) for name, default in params.items()):
            raise ValueError("Logging filter parameters cannot be changed between calls.")
