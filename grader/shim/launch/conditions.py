"""Conditions of actions."""

from __future__ import annotations

from launch._evaluation import Condition, LaunchContext, perform

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

__all__ = [
    "IfCondition",
    "InvalidConditionExpressionError",
    "LaunchConfigurationEquals",
    "LaunchConfigurationNotEquals",
    "UnlessCondition",
    "evaluate_condition_expression",
]

_TRUE = ("true", "1")
_FALSE = ("false", "0")


class InvalidConditionExpressionError(Exception):
    """An expression is neither true nor false."""


def evaluate_condition_expression(context: LaunchContext, expression: Any) -> bool:
    """Return the truth of an expression.

    Raises InvalidConditionExpressionError: it is neither true nor false.
    """
    text = perform(context, expression)
    if text.strip().lower() not in _TRUE + _FALSE:
        raise InvalidConditionExpressionError(
            f"invalid condition expression '{text}', expected one of {[*_TRUE, *_FALSE]}"
        )
    return text.strip().lower() in _TRUE


class IfCondition(Condition):
    """Holds where an expression is true."""

    def __init__(self, predicate_expression: Any) -> None:
        super().__init__(
            predicate=lambda context: evaluate_condition_expression(context, predicate_expression)
        )


class UnlessCondition(Condition):
    """Holds where an expression is false."""

    def __init__(self, predicate_expression: Any) -> None:
        super().__init__(
            predicate=lambda context: not evaluate_condition_expression(context, predicate_expression)
        )


class LaunchConfigurationEquals(Condition):
    """Holds where a launch argument has a value."""

    def __init__(self, launch_configuration_name: str, expected_value: Any) -> None:
        def equal(context: LaunchContext) -> bool:
            value = context.launch_configurations.get(launch_configuration_name)
            return value == (None if expected_value is None else perform(context, expected_value))

        super().__init__(predicate=equal)


class LaunchConfigurationNotEquals(Condition):
    """Holds where a launch argument has another value."""

    def __init__(self, launch_configuration_name: str, expected_value: Any) -> None:
        same = LaunchConfigurationEquals(launch_configuration_name, expected_value)
        super().__init__(predicate=lambda context: not same.evaluate(context))
