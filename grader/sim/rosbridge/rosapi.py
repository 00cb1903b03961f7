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


_Service = Callable[[Mapping[str, Any], KnownGraph], dict[str, Any]]


def answer(name: str, args: Mapping[str, Any], graph: KnownGraph) -> dict[str, Any] | None:
    """Return the response of the service ``/rosapi/<name>``; None where there is none of that name.

    Raises FrameError: the request lacks something, or asks for what does not exist.
    """
    serve = _SERVICES.get(name)
    return None if serve is None else serve(args, graph)


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


def _of_type(types: Mapping[str, str], type_name: str) -> list[str]:
    return [name for name, kind in types.items() if kind == type_name]


def _topics(_: Mapping[str, Any], graph: KnownGraph) -> dict[str, Any]:
    return {"topics": list(graph.topics), "types": list(graph.topics.values())}


def _topics_and_raw_types(args: Mapping[str, Any], graph: KnownGraph) -> dict[str, Any]:
    texts = [_definition(kind, graph.types) for kind in graph.topics.values()]
    return {**_topics(args, graph), "typedefs_full_text": texts}


def _node_details(args: Mapping[str, Any], graph: KnownGraph) -> dict[str, Any]:
    node = _asked(args, "node")
    topics = [name for name in graph.topics if graph.node_of(name) == node]
    return {
        "subscribing": [name for name in topics if name.endswith("/cmd_vel")],
        "publishing": [name for name in topics if not name.endswith("/cmd_vel")],
        "services": [name for name in graph.services if graph.node_of(name) == node],
    }


def _service_node(args: Mapping[str, Any], graph: KnownGraph) -> dict[str, Any]:
    service = _asked(args, "service")
    return {"node": graph.node_of(service) if service in graph.services else ""}


def _service_providers(args: Mapping[str, Any], graph: KnownGraph) -> dict[str, Any]:
    service = _asked(args, "service")
    return {"providers": [graph.node_of(service)] if service in graph.services else []}


def _publishers(args: Mapping[str, Any], graph: KnownGraph) -> dict[str, Any]:
    topic = _asked(args, "topic")
    is_published = topic in graph.topics and not topic.endswith("/cmd_vel")
    return {"publishers": [graph.node_of(topic)] if is_published else []}


def _subscribers(args: Mapping[str, Any], graph: KnownGraph) -> dict[str, Any]:
    topic = _asked(args, "topic")
    is_heard = topic in graph.topics and topic.endswith("/cmd_vel")
    return {"subscribers": [graph.node_of(topic)] if is_heard else []}


def _details_of(part: str, kind: str) -> _Service:
    return lambda args, graph: {
        "typedefs": _typedefs(f"{full_type(_asked(args, 'type'), kind)}_{part}", graph.types)
    }


def _typedefs(name: str, types: Types) -> list[dict[str, Any]]:
    """Return the definition of a type, then those of the types in it."""
    if name not in types.fields:
        raise FrameError(f"unknown type {name}")
    names = [name]
    for each in names:  # grows on the way
        for _, text in types.fields[each]:
            inner = _base(text)
            if inner in types.fields and inner not in names and len(names) < _MOST_TYPES:
                names.append(inner)
    return [_typedef(each, types) for each in names]


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


_SERVICES: Final[dict[str, _Service]] = {
    "topics": _topics,
    "topics_for_type": lambda args, graph: {
        "topics": _of_type(graph.topics, full_type(_asked(args, "type")))
    },
    "topics_and_raw_types": _topics_and_raw_types,
    "topic_type": lambda args, graph: {"type": graph.topics.get(_asked(args, "topic"), "")},
    "publishers": _publishers,
    "subscribers": _subscribers,
    "services": lambda _, graph: {"services": list(graph.services)},
    "services_for_type": lambda args, graph: {
        "services": _of_type(graph.services, full_type(_asked(args, "type"), "srv"))
    },
    "service_type": lambda args, graph: {"type": graph.services.get(_asked(args, "service"), "")},
    "service_node": _service_node,
    "service_providers": _service_providers,
    "nodes": lambda _, graph: {"nodes": list(graph.nodes)},
    "node_details": _node_details,
    "action_servers": lambda _, graph: {
        "action_servers": [name.removesuffix(_GOAL) for name in graph.services if name.endswith(_GOAL)]
    },
    "action_type": lambda args, graph: {
        "type": graph.services.get(f"{_asked(args, 'action')}{_GOAL}", "").removesuffix("_SendGoal")
    },
    "interfaces": lambda _, graph: {
        "interfaces": sorted({_PARTS.sub("", name) for name in graph.types.fields})
    },
    "message_details": lambda args, graph: {
        "typedefs": _typedefs(full_type(_asked(args, "type")), graph.types)
    },
    "service_request_details": _details_of("Request", "srv"),
    "service_response_details": _details_of("Response", "srv"),
    "action_goal_details": _details_of("Goal", "action"),
    "action_result_details": _details_of("Result", "action"),
    "action_feedback_details": _details_of("Feedback", "action"),
    "get_time": lambda _, graph: {"time": stamp(graph.now_ns)},
    "get_ros_version": lambda *_: {"version": 2, "distro": "humble"},
}
