"""What the graph knows of a publisher or subscription."""

from __future__ import annotations

from enum import IntEnum

from rclpy.qos import QoSHistoryPolicy, QoSPresetProfiles, QoSProfile, _checked, _same

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class TopicEndpointTypeEnum(IntEnum):
    """Kinds of endpoints."""

    INVALID = 0
    PUBLISHER = 1
    SUBSCRIPTION = 2


def _profile(value: QoSProfile | dict[str, Any]) -> QoSProfile:
    return QoSProfile(**value) if isinstance(value, dict) else value


class TopicEndpointInfo:
    """One endpoint of a topic; AssertionError for unknown keywords or values of wrong types."""

    __slots__ = [
        "_endpoint_gid",
        "_endpoint_type",
        "_node_name",
        "_node_namespace",
        "_qos_profile",
        "_topic_type",
    ]

    def __init__(self, **kwargs: Any) -> None:
        assert all("_" + key in self.__slots__ for key in kwargs), (
            f"Invalid arguments passed to constructor: {kwargs.keys()!r}"
        )
        self.node_name = kwargs.get("node_name", "")  # noqa: PLE0237 - a property
        self.node_namespace = kwargs.get("node_namespace", "")  # noqa: PLE0237 - a property
        self.topic_type = kwargs.get("topic_type", "")  # noqa: PLE0237 - a property
        self.endpoint_type = kwargs.get("endpoint_type", TopicEndpointTypeEnum.INVALID)  # noqa: PLE0237 - a property
        self.endpoint_gid = kwargs.get("endpoint_gid", [])
        self.qos_profile = kwargs.get("qos_profile", QoSPresetProfiles.UNKNOWN.value)  # noqa: PLE0237 - a property

    node_name = _checked("node_name", str, _same)
    node_namespace = _checked("node_namespace", str, _same)
    topic_type = _checked("topic_type", str, _same)
    endpoint_type = _checked("endpoint_type", int, TopicEndpointTypeEnum)
    qos_profile = _checked("qos_profile", (QoSProfile, dict), _profile)

    @property
    def endpoint_gid(self) -> list[int]:
        return self._endpoint_gid

    @endpoint_gid.setter
    def endpoint_gid(self, value: list[int]) -> None:
        assert all(isinstance(x, int) for x in value)
        self._endpoint_gid = value

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, TopicEndpointInfo):
            return False
        return all(getattr(self, slot) == getattr(other, slot) for slot in self.__slots__)

    __hash__ = None  # type: ignore[assignment]

    def __str__(self) -> str:
        qos = self.qos_profile
        history = qos.history.name
        if qos.history == QoSHistoryPolicy.KEEP_LAST:
            history += f" ({qos.depth})"
        return "\n".join(
            [
                f"Node name: {self.node_name}",
                f"Node namespace: {self.node_namespace}",
                f"Topic type: {self.topic_type}",
                f"Endpoint type: {self.endpoint_type.name}",
                f"GID: {'.'.join(format(x, '02x') for x in self.endpoint_gid)}",
                "QoS profile:",
                f"  Reliability: {qos.reliability.name}",
                f"  History (Depth): {history}",
                f"  Durability: {qos.durability.name}",
                f"  Lifespan: {qos.lifespan}",
                f"  Deadline: {qos.deadline}",
                f"  Liveliness: {qos.liveliness.name}",
                f"  Liveliness lease duration: {qos.liveliness_lease_duration}",
            ]
        )
