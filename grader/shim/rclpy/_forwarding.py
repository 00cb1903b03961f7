"""Names that a module of upstream passes on because it imports them.

Editors complete ``from rclpy.node import Timer``, and that works on Humble, as does ``from rclpy.node import *``;
here such a name is looked up when a script asks for it.
"""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from typing import Any

_HOMES = {
    "concurrent.futures": "ThreadPoolExecutor",
    "contextlib": "ExitStack",
    "enum": "IntEnum",
    "rcl_interfaces.msg": """
        FloatingPointRange IntegerRange ParameterDescriptor ParameterEvent ParameterType ParameterValue
        SetParametersResult
    """,
    "rcl_interfaces.srv": """
        DescribeParameters GetParameterTypes GetParameters ListParameters SetParameters
        SetParametersAtomically
    """,
    "rclpy.callback_groups": "CallbackGroup ReentrantCallbackGroup",
    "rclpy.client": "Client",
    "rclpy.clock": "Clock ClockType",
    "rclpy.context": "Context",
    "rclpy.exceptions": """
        InvalidHandle InvalidParameterTypeException InvalidParameterValueException
        InvalidTopicNameException ParameterAlreadyDeclaredException ParameterImmutableException
        ParameterNotDeclaredException ParameterUninitializedException
    """,
    "rclpy.executors": "Executor",
    "rclpy.expand_topic_name": "expand_topic_name",
    "rclpy.guard_condition": "GuardCondition",
    "rclpy.node": "Node",
    "rclpy.parameter": "PARAMETER_SEPARATOR_STRING Parameter",
    "rclpy.parameter_service": "ParameterService",
    "rclpy.qos": "QoSProfile qos_profile_services_default",
    "rclpy.qos_event": "PublisherEventCallbacks QoSEventHandler SubscriptionEventCallbacks",
    "rclpy.qos_overriding_options": "QoSOverridingOptions _declare_qos_parameters",
    "rclpy.service": "Service",
    "rclpy.signals": "SignalHandlerGuardCondition",
    "rclpy.subscription": "Subscription",
    "rclpy.time_source": "TimeSource",
    "rclpy.timer": "Rate Timer",
    "rclpy.topic_endpoint_info": "TopicEndpointInfo",
    "rclpy.type_support": "check_is_valid_srv_type",
    "rclpy.validate_parameter_name": "validate_parameter_name",
    "rclpy.waitable": "NumberOfEntities Waitable",
    "threading": "Condition Lock RLock",
    "typing": """
        Any Callable Coroutine Dict Generator Iterable Iterator List NamedTuple Optional Sequence Set Text
        Tuple Type TypeVar Union
    """,
    "unique_identifier_msgs.msg": "UUID",
}
"""Module -> names that others pass on."""

_RENAMED = {
    "ParameterMsg": ("rcl_interfaces.msg", "Parameter"),
    "QosCallbackResult": ("rcl_interfaces.msg", "SetParametersResult"),
    "QosCallbackType": ("typing", "Callable"),
}
_MODULES = frozenset(("inspect", "math", "threading", "time", "uuid", "warnings", "weakref"))
_TYPE_VARIABLES = frozenset(("MsgType", "SrvType", "SrvTypeRequest", "SrvTypeResponse", "WaitableEntityType"))

_PASSED_ON = {
    "rclpy": "List Optional",
    "rclpy.action.client": "UUID threading time uuid",
    "rclpy.action.graph": "List Node Tuple",
    "rclpy.client": """
        CallbackGroup Context Dict QoSProfile SrvType SrvTypeRequest SrvTypeResponse TypeVar threading time
    """,
    "rclpy.context": "Callable List Optional threading weakref",
    "rclpy.executors": """
        Any Callable Client Clock ClockType Condition Context Coroutine ExitStack Generator List Lock
        NumberOfEntities Optional RLock Service Set SignalHandlerGuardCondition Subscription
        ThreadPoolExecutor Timer Tuple TypeVar Union Waitable WaitableEntityType inspect time
    """,
    "rclpy.lifecycle.node": "Callable CallbackGroup Dict NamedTuple Optional Set check_is_valid_srv_type",
    "rclpy.lifecycle.publisher": "MsgType Union",
    "rclpy.node": """
        Any Callable CallbackGroup Client Clock Context Dict Executor FloatingPointRange GuardCondition
        IntegerRange InvalidHandle InvalidParameterTypeException InvalidParameterValueException
        InvalidTopicNameException Iterator List MsgType Optional PARAMETER_SEPARATOR_STRING
        ParameterAlreadyDeclaredException ParameterDescriptor ParameterEvent ParameterImmutableException
        ParameterMsg ParameterNotDeclaredException ParameterService ParameterType
        ParameterUninitializedException ParameterValue PublisherEventCallbacks QoSOverridingOptions
        QoSProfile Rate ReentrantCallbackGroup Sequence Service SetParametersResult SrvType SrvTypeRequest
        SrvTypeResponse Subscription SubscriptionEventCallbacks TimeSource Timer TopicEndpointInfo Tuple
        Type TypeVar Union Waitable _declare_qos_parameters expand_topic_name math qos_profile_services_default
        validate_parameter_name warnings weakref
    """,
    "rclpy.parameter": "ParameterMsg ParameterType ParameterValue",
    "rclpy.parameter_service": """
        DescribeParameters GetParameterTypes GetParameters ListParameters SetParameters
        SetParametersAtomically SetParametersResult weakref
    """,
    "rclpy.publisher": """
        CallbackGroup MsgType PublisherEventCallbacks QoSEventHandler QoSProfile TypeVar Union
    """,
    "rclpy.qos": "Union warnings",
    "rclpy.qos_event": "Callable CallbackGroup IntEnum List Optional",
    "rclpy.qos_overriding_options": """
        Callable Iterable Optional Parameter ParameterDescriptor SetParametersResult Text Type Union
        QosCallbackResult QosCallbackType
    """,
    "rclpy.service": "Callable CallbackGroup QoSProfile SrvType SrvTypeRequest SrvTypeResponse TypeVar",
    "rclpy.signals": "InvalidHandle",
    "rclpy.subscription": """
        Callable CallbackGroup QoSEventHandler QoSProfile SubscriptionEventCallbacks TypeVar MsgType
    """,
    "rclpy.time_source": "SetParametersResult weakref",
    "rclpy.wait_for_message": "Node QoSProfile SignalHandlerGuardCondition Union",
}
"""Module of Humble -> what it imports or declares besides what stands in ours."""


def passed_on(module: str) -> Callable[[str], Any]:
    """Return the `__getattr__` of a module in `_PASSED_ON`."""

    def find(name: str) -> Any:
        names = _PASSED_ON[module].split()
        if name == "__all__":
            return _with_own(module, names)
        return _find(module, name) if name in names else _missing(module, name)

    return find


def _with_own(module: str, names: list[str]) -> list[str]:
    """Return what ``from module import *`` gives; Python asks for it as ``__all__``."""
    import sys

    own = [name for name in vars(sys.modules[module]) if not name.startswith("_")]
    return own + [name for name in names if not name.startswith("_")]


def _find(module: str, name: str) -> Any:
    if name in _TYPE_VARIABLES:
        import sys
        from typing import TypeVar

        found: Any = TypeVar(name)  # type: ignore[misc]
        return sys.modules[module].__dict__.setdefault(name, found)
    from importlib import import_module

    if name in _MODULES:
        return import_module(name)
    home, theirs = _RENAMED.get(name) or next(
        (home, name) for home, names in _HOMES.items() if name in names.split()
    )
    return getattr(import_module(home), theirs)


def _missing(module: str, name: str) -> Any:
    raise AttributeError(f"module {module!r} has no attribute {name!r}")


def forwarding(module: str, names: Mapping[str, str]) -> Callable[[str], Any]:
    """Return the `__getattr__` of `module`; `names` are separated by spaces, by the module they come from."""

    def find(name: str) -> Any:
        for home, passed in names.items():
            if name in passed.split():
                from importlib import import_module

                return getattr(import_module(home), name)
        return _missing(module, name)

    return find
