"""The information about an endpoint includes the hash of its type."""

from __future__ import annotations

from rclpy import topic_endpoint_info
from rclpy._jazzy.overlay import replace
from rclpy.type_hash import TypeHash

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def _set_hash(self: Any, value: TypeHash | dict[str, Any]) -> None:
    assert isinstance(value, (TypeHash, dict))
    self._topic_type_hash = TypeHash(**value) if isinstance(value, dict) else value


class TopicEndpointInfo(topic_endpoint_info.TopicEndpointInfo):
    """One endpoint of a topic; AssertionError for unknown keywords or values of wrong types."""

    __slots__ = [
        "_endpoint_gid",
        "_endpoint_type",
        "_node_name",
        "_node_namespace",
        "_qos_profile",
        "_topic_type",
        "_topic_type_hash",
    ]

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.topic_type_hash = kwargs.get("topic_type_hash", TypeHash())

    topic_type_hash = property(lambda self: self._topic_type_hash, _set_hash)

    def __str__(self) -> str:
        head, mark, rest = super().__str__().partition("\nEndpoint type: ")
        return f"{head}\nTopic type hash: {self.topic_type_hash}{mark}{rest}"


replace(topic_endpoint_info, TopicEndpointInfo=TopicEndpointInfo)
