"""QoS settings that parameters of a node can override."""

from __future__ import annotations

from rclpy._forwarding import passed_on
from rclpy.duration import Duration
from rclpy.exceptions import ParameterAlreadyDeclaredException
from rclpy.publisher import Publisher
from rclpy.qos import QoSPolicyKind, QoSProfile
from rclpy.subscription import Subscription

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from typing import Any, Protocol

    from rclpy.parameter import Parameter

    class Node(Protocol):
        """What is needed of a node; importing `rclpy.node` for it would close a circle."""

        def declare_parameter(self, name: str, value: Any, descriptor: Any) -> Parameter:
            """Declare a parameter."""

        def get_parameter(self, name: str) -> Parameter:
            """Return a parameter."""


__getattr__ = passed_on(__name__)

_ENUMS = (
    QoSPolicyKind.LIVELINESS,
    QoSPolicyKind.RELIABILITY,
    QoSPolicyKind.HISTORY,
    QoSPolicyKind.DURABILITY,
)
_PERIODS = (QoSPolicyKind.LIFESPAN, QoSPolicyKind.DEADLINE, QoSPolicyKind.LIVELINESS_LEASE_DURATION)


class InvalidQosOverridesError(Exception):
    """The callback rejected the overridden profile."""


class QoSOverridingOptions:
    """Which policies of a publisher or subscription parameters may override, and who checks the result."""

    def __init__(
        self,
        policy_kinds: Iterable[QoSPolicyKind],
        *,
        callback: Callable[[QoSProfile], Any] | None = None,
        entity_id: str | None = None,
    ) -> None:
        self._policy_kinds = policy_kinds
        self._callback = callback
        self._entity_id = entity_id

    @property
    def policy_kinds(self) -> Iterable[QoSPolicyKind]:
        return self._policy_kinds

    @property
    def callback(self) -> Callable[[QoSProfile], Any] | None:
        return self._callback

    @property
    def entity_id(self) -> str | None:
        return self._entity_id

    @classmethod
    def with_default_policies(
        cls, *, callback: Callable[[QoSProfile], Any] | None = None, entity_id: str | None = None
    ) -> QoSOverridingOptions:
        """Return options for history, depth and reliability."""
        return cls(
            policy_kinds=(QoSPolicyKind.HISTORY, QoSPolicyKind.DEPTH, QoSPolicyKind.RELIABILITY),
            callback=callback,
            entity_id=entity_id,
        )


def _declare_qos_parameters(
    entity_type: type[Publisher] | type[Subscription],
    node: Node,
    topic_name: str,
    qos: QoSProfile,
    options: QoSOverridingOptions,
) -> None:
    """Declare a read-only parameter per policy and change `qos` to their values.

    Raises:
        TypeError: the entity is neither publisher nor subscription.
        InvalidQosOverridesError: the callback rejected the result.
    """
    if not issubclass(entity_type, (Publisher, Subscription)):
        raise TypeError("Argument `entity_type` should be a subclass of Publisher or Subscription")
    kind = "publisher" if issubclass(entity_type, Publisher) else "subscription"
    suffix = "" if options.entity_id is None else f"_{options.entity_id}"
    tail = f" for {kind} `{topic_name}` with id `{options.entity_id}`"
    for policy in options.policy_kinds:
        if policy not in _get_allowed_policies(entity_type):
            continue
        name = f"qos_overrides.{topic_name}.{kind}{suffix}.{policy.name.lower()}"
        _override_qos_policy_with_param(qos, policy, _declare(node, name, qos, policy, tail))
    if options.callback is not None:
        result = options.callback(qos)
        if not result.successful:
            raise InvalidQosOverridesError(f"Provided QoS overrides{tail}, are not valid: {result.reason}")


def _declare(node: Node, name: str, qos: QoSProfile, policy: QoSPolicyKind, tail: str) -> Parameter:
    from rclpy._interfaces.own import ParameterDescriptor

    descriptor = ParameterDescriptor()
    descriptor.description = policy.name.lower() + tail
    descriptor.read_only = True
    try:
        return node.declare_parameter(name, _get_qos_policy_parameter(qos, policy), descriptor)
    except ParameterAlreadyDeclaredException:
        return node.get_parameter(name)


def _get_allowed_policies(entity_type: type[Publisher] | type[Subscription]) -> list[QoSPolicyKind]:
    policies = list(QoSPolicyKind)
    if issubclass(entity_type, Subscription):
        policies.remove(QoSPolicyKind.LIFESPAN)
    return policies


def _get_qos_policy_parameter(qos: QoSProfile, policy: QoSPolicyKind) -> Any:
    value = getattr(qos, policy.name.lower())
    if policy in _ENUMS:
        value = value.name.lower()
        if value == "unknown":
            raise ValueError("User provided QoS profile is invalid")
    if policy in _PERIODS:
        value = value.nanoseconds
    return value


def _override_qos_policy_with_param(qos: QoSProfile, policy: QoSPolicyKind, param: Parameter) -> None:
    value = param.value
    name = policy.name.lower()
    if policy in _ENUMS:
        try:
            value = type(getattr(qos, name))[value.upper()]
        except KeyError:
            raise RuntimeError(f"Unexpected QoS override for policy `{name}`: `{value}`") from None
    if policy in _PERIODS:
        value = Duration(nanoseconds=value)
    setattr(qos, name, value)
