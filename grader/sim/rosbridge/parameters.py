"""rosapi's services for parameters, whose names are ``/node:name`` and whose values are JSON texts.

As rosapi of ROS 2 Humble, they ask the node's own services. What is not there reads as the default that was given;
setting what cannot be set gives no error.
"""

from collections.abc import Callable, Mapping
from typing import Any, Final

import msgspec

from grader.sim.rosbridge.actions import Graph, Reply
from grader.sim.rosbridge.frames import FrameError

_FIELDS: Final = {
    1: "bool_value",
    2: "integer_value",
    3: "double_value",
    4: "string_value",
    6: "bool_array_value",
    7: "integer_array_value",
    8: "double_array_value",
    9: "string_array_value",
}
_KINDS: Final = {bool: 1, int: 2, float: 3, str: 4}
_LIST: Final = "/list_parameters"
_MOST_NODES: Final = 8
_LONGEST: Final = 1_000


class RosapiParameters:
    """Answers them. `services` returns the types of the graph's services by name."""

    def __init__(self, bridge: Graph, services: Callable[[], Mapping[str, str]]) -> None:
        self._bridge = bridge
        self._services = services
        self._handlers: dict[str, Callable[[int, Mapping[str, Any], Reply], None]] = {
            "get_param": self._get,
            "has_param": self._has,
            "set_param": self._set,
            "get_param_names": self._names,
        }

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the services, without ``/rosapi/``."""
        return tuple(self._handlers)

    def ask(self, client: int, name: str, args: Mapping[str, Any], reply: Reply) -> None:
        """Answer one of `names`. Raises FrameError: the request lacks what it needs."""
        self._handlers[name](client, args, reply)

    def _get(self, client: int, args: Mapping[str, Any], reply: Reply) -> None:
        default = _text(args, "default_value")
        otherwise = {"value": _json(_read(default) if default else "")}

        def done(answer: Mapping[str, Any]) -> None:
            value = _value(answer)
            reply.done(otherwise if value is None else {"value": _json(value)})

        self._read_one(client, args, Reply(done, lambda _: reply.done(otherwise)))

    def _has(self, client: int, args: Mapping[str, Any], reply: Reply) -> None:
        def done(answer: Mapping[str, Any]) -> None:
            reply.done({"exists": _value(answer) is not None})

        self._read_one(client, args, Reply(done, lambda _: reply.done({"exists": False})))

    def _set(self, client: int, args: Mapping[str, Any], reply: Reply) -> None:
        node, name = _place(args)
        value = _read(_text(args, "value"))
        kind = _KINDS.get(type(value))
        service = f"{node}/set_parameters"
        if kind is None or self._bridge.service_type(service) is None:
            reply.done({})
            return
        parameter = {"name": name, "value": {"type": kind, _FIELDS[kind]: value}}
        answers = Reply(lambda _: reply.done({}), lambda _: reply.done({}))
        self._bridge.call(client, service, {"parameters": [parameter]}, answers, waits=False)

    def _names(self, client: int, args: Mapping[str, Any], reply: Reply) -> None:
        """Ask one node after the other."""
        nodes = [name.removesuffix(_LIST) for name in self._services() if name.endswith(_LIST)][:_MOST_NODES]
        names: list[str] = []

        def ask_next() -> None:
            if not nodes:
                reply.done({"names": names})
                return
            node = nodes.pop(0)

            def done(answer: Mapping[str, Any]) -> None:
                names.extend(f"{node}:{name}" for name in answer["result"]["names"])
                ask_next()

            self._bridge.call(client, f"{node}{_LIST}", {}, Reply(done, lambda _: ask_next()), waits=False)

        ask_next()

    def _read_one(self, client: int, args: Mapping[str, Any], reply: Reply) -> None:
        node, name = _place(args)
        service = f"{node}/get_parameters"
        if self._bridge.service_type(service) is None:
            reply.failed(f"no node {node}")
        else:
            self._bridge.call(client, service, {"names": [name]}, reply, waits=False)


def _place(args: Mapping[str, Any]) -> tuple[str, str]:
    node, colon, name = _text(args, "name").partition(":")
    if not colon or not name:
        raise FrameError("name: /node:parameter is expected")
    return node if node.startswith("/") else f"/{node}", name


def _text(args: Mapping[str, Any], field: str) -> str:
    value = args.get(field, "")
    if not isinstance(value, str) or len(value) > _LONGEST or "\0" in value:
        raise FrameError(f"{field}: a text of at most {_LONGEST} characters is expected")
    return value


def _read(text: str) -> Any:
    """Return what a JSON text says, or the text itself."""
    try:
        return msgspec.json.decode(text)
    except (msgspec.DecodeError, RecursionError, UnicodeEncodeError):
        return text


def _json(value: Any) -> str:
    return msgspec.json.encode(value).decode()


def _value(answer: Mapping[str, Any]) -> Any:
    """Return the value of the one parameter that was asked for; None where it is not set."""
    values = answer["values"]
    field = _FIELDS.get(values[0]["type"]) if values else None
    return None if field is None else values[0][field]
