"""The services through which others read and set the levels of a node's loggers."""

from __future__ import annotations

from rclpy._interfaces.own import LazyType
from rclpy.impl.logging_severity import LoggingSeverity
from rclpy.logging import get_logger_level, set_logger_level  # type: ignore[attr-defined]
from rclpy.qos import qos_profile_services_default
from rclpy.validate_topic_name import TOPIC_SEPARATOR_STRING

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class LoggingService:
    """Creates and answers the two logging services of a node."""

    def __init__(self, node: Any) -> None:
        for name, kind, callback in (
            ("get_logger_levels", "GetLoggerLevels", self._get_logger_levels),
            ("set_logger_levels", "SetLoggerLevels", self._set_logger_levels),
        ):
            full_name = TOPIC_SEPARATOR_STRING.join((node.get_name(), name))
            lazy = LazyType(f"rcl_interfaces/srv/{kind}")
            node._rcl_add_own_service(lazy, full_name, callback, qos_profile_services_default)

    def _get_logger_levels(self, request: Any, response: Any) -> Any:
        from rcl_interfaces.msg import LoggerLevel

        for name in request.names:
            try:
                level = get_logger_level(name)
            except RuntimeError:
                level = LoggingSeverity.UNSET
            response.levels.append(LoggerLevel(name=name, level=level))
        return response

    def _set_logger_levels(self, request: Any, response: Any) -> Any:
        from rcl_interfaces.msg import SetLoggerLevelsResult

        for wanted in request.levels:
            reason = ""
            try:
                set_logger_level(wanted.name, wanted.level, detailed_error=True)  # type: ignore[call-arg]
            except ValueError:
                reason = "Failed reason: Invalid logger level."
            except RuntimeError as error:
                reason = str(error)
            response.results.append(SetLoggerLevelsResult(successful=not reason, reason=reason))
        return response
