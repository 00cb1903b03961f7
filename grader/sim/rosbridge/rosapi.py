"""The services of /rosapi that clients ask, as rosapi of ROS 2 Humble answers them."""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from grader.sim.interfaces import Types, stamp
from grader.sim.rosbridge.frames import FrameError
from grader.sim.rosbridge.values import full_type

PREFIX: Final = "/rosapi/"
NODES: Final = ("/rosapi", "/rosbridge_websocket")
_GOAL: Final = "/_action/send_goal"
_MOST_TYPES: Final = 64
_OTHER_NAMES: Final = {"action_servers": "GetActionServers", "get_ros_version": "GetROSVersion"}
_PARTS: Final = re.compile(
    "_(SendGoal_Request|SendGoal_Response|GetResult_Request|GetResult_Response|FeedbackMessage"
    "|Request|Response|Goal|Result|Feedback)$"
)
"""Ends of the names of structures that an interface is made of."""

_NUMBERS: Final = ("bool", "int", "uint", "float")


@dataclass(frozen=True, slots=True)
class KnownGraph:
    """The graph as rosapi tells it.

    Attributes:
        topics, services: types by name. publishers, subscribers: nodes by topic.
        providers: node by service. types: what is known of types. now_ns: the wall clock.
    """

    topics: Mapping[str, str]
    services: Mapping[str, str]
    nodes: Sequence[str]
    types: Types
    now_ns: int
    node_of: Callable[[str], str]


def answer(name: str, args: Mapping[str, Any], roster: KnownGraph) -> dict[str, Any] | None:
    """Return the response of the service ``/rosapi/<name>``; None where there is none of that name.

    Raises:
        FrameError: the request lacks something, or asks for what does not exist.
    """
    serve = _SERVICES.get(name)
    return None if serve is None else serve(args, roster)


def types(others: Iterable[str] = ()) -> dict[str, str]:
    """Return the types of all services that `answer` knows, and of `others`, by their full names."""
    return {PREFIX + name: f"rosapi_msgs/srv/{_type_name(name)}" for name in (*_SERVICES, *others)}


def _type_name(service: str) -> str:
    return _OTHER_NAMES.get(service) or "".join(word.capitalize() for word in service.split("_"))


def _asked(args: Mapping[str, Any], field: str) -> str:
    value = args.get(field, "")
    if not isinstance(value, str) or len(value) > 256:
        raise FrameError(f"{field}: a text of at most 256 characters is expected")
    return value


def _topics(_: Mapping[str, Any], roster: KnownGraph) -> dict[str, Any]:
    return {"topics": list(roster.topics), "types": list(roster.topics.values())}


def _topics_for_type(args: Mapping[str, Any], roster: KnownGraph) -> dict[str, Any]:
    wanted = full_type(_asked(args, "type"))
    return {"topics": [name for name, kind in roster.topics.items() if kind == wanted]}


def _topics_and_raw_types(args: Mapping[str, Any], roster: KnownGraph) -> dict[str, Any]:
    texts = [_definition(kind, roster.types) for kind in roster.topics.values()]
    return {**_topics(args, roster), "typedefs_full_text": texts}


def _services(_: Mapping[str, Any], roster: KnownGraph) -> dict[str, Any]:
    return {"services": list(roster.services)}


def _services_for_type(args: Mapping[str, Any], roster: KnownGraph) -> dict[str, Any]:
    wanted = full_type(_asked(args, "type"), "srv")
    return {"services": [name for name, kind in roster.services.items() if kind == wanted]}


def _nodes(_: Mapping[str, Any], roster: KnownGraph) -> dict[str, Any]:
    return {"nodes": list(roster.nodes)}


def _node_details(args: Mapping[str, Any], roster: KnownGraph) -> dict[str, Any]:
    node = _asked(args, "node")
    topics = [name for name in roster.topics if roster.node_of(name) == node]
    return {
        "subscribing": [name for name in topics if name.endswith("/cmd_vel")],
        "publishing": [name for name in topics if not name.endswith("/cmd_vel")],
        "services": [name for name in roster.services if roster.node_of(name) == node],
    }


def _topic_type(args: Mapping[str, Any], roster: KnownGraph) -> dict[str, Any]:
    return {"type": roster.topics.get(_asked(args, "topic"), "")}


def _service_type(args: Mapping[str, Any], roster: KnownGraph) -> dict[str, Any]:
    return {"type": roster.services.get(_asked(args, "service"), "")}


def _service_node(args: Mapping[str, Any], roster: KnownGraph) -> dict[str, Any]:
    service = _asked(args, "service")
    return {"node": roster.node_of(service) if service in roster.services else ""}


def _service_providers(args: Mapping[str, Any], roster: KnownGraph) -> dict[str, Any]:
    service = _asked(args, "service")
    return {"providers": [roster.node_of(service)] if service in roster.services else []}


def _publishers(args: Mapping[str, Any], roster: KnownGraph) -> dict[str, Any]:
    topic = _asked(args, "topic")
    told = topic in roster.topics and not topic.endswith("/cmd_vel")
    return {"publishers": [roster.node_of(topic)] if told else []}


def _subscribers(args: Mapping[str, Any], roster: KnownGraph) -> dict[str, Any]:
    topic = _asked(args, "topic")
    told = topic in roster.topics and topic.endswith("/cmd_vel")
    return {"subscribers": [roster.node_of(topic)] if told else []}


def _action_servers(_: Mapping[str, Any], roster: KnownGraph) -> dict[str, Any]:
    return {"action_servers": [name.removesuffix(_GOAL) for name in roster.services if name.endswith(_GOAL)]}


def _action_type(args: Mapping[str, Any], roster: KnownGraph) -> dict[str, Any]:
    kind = roster.services.get(f"{_asked(args, 'action')}{_GOAL}", "")
    return {"type": kind.removesuffix("_SendGoal")}


def _interfaces(_: Mapping[str, Any], roster: KnownGraph) -> dict[str, Any]:
    known = {_PARTS.sub("", name) for name in roster.types.fields}
    return {"interfaces": sorted(known)}


def _get_time(_: Mapping[str, Any], roster: KnownGraph) -> dict[str, Any]:
    return {"time": stamp(roster.now_ns)}


def _get_ros_version(_: Mapping[str, Any], roster: KnownGraph) -> dict[str, Any]:
    return {"version": 2, "distro": "humble"}


def _message_details(args: Mapping[str, Any], roster: KnownGraph) -> dict[str, Any]:
    return {"typedefs": _typedefs(full_type(_asked(args, "type")), roster.types)}


def _details_of(part: str, kind: str) -> Callable[[Mapping[str, Any], KnownGraph], dict[str, Any]]:
    def serve(args: Mapping[str, Any], roster: KnownGraph) -> dict[str, Any]:
        return {"typedefs": _typedefs(f"{full_type(_asked(args, 'type'), kind)}_{part}", roster.types)}

    return serve


def _typedefs(name: str, types: Types) -> list[dict[str, Any]]:
    """Return the definition of a type, then those of the types in it."""
    if name not in types.fields:
        raise FrameError(f"unknown type {name}")
    wanted = [name]
    for each in wanted:  # grows on the way
        for _, text in types.fields[each]:
            inner = _base(text)
            if inner in types.fields and inner not in wanted and len(wanted) < _MOST_TYPES:
                wanted.append(inner)
    return [_typedef(each, types) for each in wanted]


def _typedef(name: str, types: Types) -> dict[str, Any]:
    fields = types.fields[name]
    return {
        "type": name,
        "fieldnames": [field for field, _ in fields],
        "fieldtypes": [_base(text) for _, text in fields],
        "fieldarraylen": [_length(text) for _, text in fields],
        "examples": [_example(text) for _, text in fields],
        "constnames": [],
        "constvalues": [],
    }


def _base(text: str) -> str:
    return text.partition("[")[0].partition("<")[0]


def _length(text: str) -> int:
    """Return -1 of a single value, 0 of a sequence, else the length of the array."""
    count = text.partition("[")[2].removesuffix("]")
    return -1 if "[" not in text else int(count) if count.isdecimal() else 0


def _example(text: str) -> str:
    if "[" in text:
        return "[]"
    base = _base(text)
    if base.startswith(_NUMBERS):
        return "False" if base == "bool" else "0.0" if base.startswith("float") else "0"
    return "" if "string" in base else "{}"


def _definition(kind: str, types: Types) -> str:
    return "".join(f"{text} {field}\n" for field, text in types.fields.get(kind, ()))


_SERVICES: Final[dict[str, Callable[[Mapping[str, Any], KnownGraph], dict[str, Any]]]] = {
    "topics": _topics,
    "topics_for_type": _topics_for_type,
    "topics_and_raw_types": _topics_and_raw_types,
    "topic_type": _topic_type,
    "publishers": _publishers,
    "subscribers": _subscribers,
    "services": _services,
    "services_for_type": _services_for_type,
    "service_type": _service_type,
    "service_node": _service_node,
    "service_providers": _service_providers,
    "nodes": _nodes,
    "node_details": _node_details,
    "action_servers": _action_servers,
    "action_type": _action_type,
    "interfaces": _interfaces,
    "message_details": _message_details,
    "service_request_details": _details_of("Request", "srv"),
    "service_response_details": _details_of("Response", "srv"),
    "action_goal_details": _details_of("Goal", "action"),
    "action_result_details": _details_of("Result", "action"),
    "action_feedback_details": _details_of("Feedback", "action"),
    "get_time": _get_time,
    "get_ros_version": _get_ros_version,
}
