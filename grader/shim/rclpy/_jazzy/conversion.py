"""On Jazzy the whole of each message is looked at before it leaves a node: its setters have checked nothing."""

from __future__ import annotations

from rclpy._interfaces import cdr, conversion
from rclpy._jazzy.overlay import replace
from rclpy._kernel import FOREVER_NS
from rclpy._rcl import endpoints

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_humble_serialize = cdr.serialize


def serialize(message: Any) -> bytes:
    """Return the CDR form of a message, or end the process."""
    conversion.check(message)
    return _humble_serialize(message)


_humble_checks_unheard = conversion.checks_unheard


def checks_unheard(full_name: str) -> int:
    """Return how many messages of a type are looked at if nobody listens: all, where that cannot take long."""
    return _humble_checks_unheard(full_name) or FOREVER_NS


replace(cdr, serialize=serialize)
replace(endpoints, checks_unheard=checks_unheard)
