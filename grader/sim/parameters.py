"""The parameters of /turtlesim, and the six services that read and set them, as rclcpp has them."""

from collections.abc import Iterable
from typing import Final

from grader.contracts.assignment import Distro
from grader.contracts.record import Record
from grader.sim.cdr import Values

BOOL, INTEGER, STRING = 1, 2, 4
_KINDS: Final = {
    0: "not set",
    BOOL: "bool",
    INTEGER: "integer",
    3: "double",
    STRING: "string",
    5: "byte_array",
    6: "bool_array",
    7: "integer_array",
    8: "double_array",
    9: "string_array",
}
_FIELDS: Final = {BOOL: "bool_value", INTEGER: "integer_value", STRING: "string_value"}
_HIGHEST: Final = 255
_QOS: Final = "qos_overrides./parameter_events.publisher"

SERVICES: Final = {
    "describe_parameters": "rcl_interfaces/srv/DescribeParameters",
    "get_parameters": "rcl_interfaces/srv/GetParameters",
    "get_parameter_types": "rcl_interfaces/srv/GetParameterTypes",
    "list_parameters": "rcl_interfaces/srv/ListParameters",
    "set_parameters": "rcl_interfaces/srv/SetParameters",
    "set_parameters_atomically": "rcl_interfaces/srv/SetParametersAtomically",
}


class _Declared(Record):
    """How a parameter was declared. A whole number with a `description` has a range of 0 to 255."""

    kind: int
    value: bool | int | str
    description: str = ""
    read_only: bool = False

    @property
    def is_ranged(self) -> bool:
        """Whether it has a range."""
        return bool(self.description) and self.kind == INTEGER


_HUMBLE: Final = {
    "background_b": _Declared(kind=INTEGER, value=255, description="Blue channel of the background color"),
    "background_g": _Declared(kind=INTEGER, value=86, description="Green channel of the background color"),
    "background_r": _Declared(kind=INTEGER, value=69, description="Red channel of the background color"),
    f"{_QOS}.depth": _Declared(kind=INTEGER, value=1000, read_only=True),
    f"{_QOS}.durability": _Declared(kind=STRING, value="volatile", read_only=True),
    f"{_QOS}.history": _Declared(kind=STRING, value="keep_last", read_only=True),
    f"{_QOS}.reliability": _Declared(kind=STRING, value="reliable", read_only=True),
    "use_sim_time": _Declared(kind=BOOL, value=False),
}
"""By name, in the order in which rclcpp keeps them."""

_JAZZY: Final = dict(
    sorted(
        {
            **_HUMBLE,
            "holonomic": _Declared(
                kind=BOOL, value=False, description="If true, then turtles will be holonomic"
            ),
            "start_type_description_service": _Declared(kind=BOOL, value=True, read_only=True),
        }.items()
    )
)
_OF: Final[dict[Distro, dict[str, _Declared]]] = {"humble": _HUMBLE, "jazzy": _JAZZY}


class Parameters:
    """Answers the services.

    A background is kept but not seen: there is no window. `holonomic` is kept, and no car slides.
    """

    def __init__(self, distro: Distro = "humble") -> None:
        self._declared = _OF[distro]
        self._values = {name: declared.value for name, declared in self._declared.items()}

    def answer(self, service: str, values: Values) -> Values:
        """Return the response of one of `SERVICES`. One unknown name makes a question's answer empty."""
        match service:
            case "list_parameters":
                return {"result": _listed(self._declared, values["prefixes"], values["depth"])}
            case "set_parameters":
                return {"results": [self._set([parameter]) for parameter in values["parameters"]]}
            case "set_parameters_atomically":
                return {"result": self._set(values["parameters"])}
        names = values["names"] if all(name in self._declared for name in values["names"]) else []
        match service:
            case "describe_parameters":
                return {"descriptors": [_descriptor(name, self._declared[name]) for name in names]}
            case "get_parameters":
                return {"values": [self._value(name) for name in names]}
            case _:
                return {"types": bytes(self._declared[name].kind for name in names)}

    def _value(self, name: str) -> Values:
        kind = self._declared[name].kind
        return {"type": kind, _FIELDS[kind]: self._values[name]}

    def _set(self, parameters: list[Values]) -> Values:
        """Set all of them, or none and say why."""
        for parameter in parameters:
            name = parameter["name"]
            if reason := _refusal(name, self._declared.get(name), parameter["value"]):
                return {"successful": False, "reason": reason}
        for parameter in parameters:
            kind = self._declared[parameter["name"]].kind
            self._values[parameter["name"]] = parameter["value"][_FIELDS[kind]]
        return {"successful": True}


def _refusal(name: str, declared: _Declared | None, value: Values) -> str:
    """Return why a parameter cannot be set, in rclcpp's words; empty when it can."""
    if declared is None:
        return f"parameter '{name}' cannot be set because it was not declared"
    if declared.read_only:
        return f"parameter '{name}' cannot be set because it is read-only"
    if value["type"] != declared.kind:
        kinds = f"is of type {{{_KINDS[declared.kind]}}}, setting it to {{{_KINDS.get(value['type'], '')}}}"
        return f"Wrong parameter type, parameter {{{name}}} {kinds} is not allowed."
    if declared.is_ranged and not 0 <= value["integer_value"] <= _HIGHEST:
        return f"Parameter {{{name}}} doesn't comply with integer range."
    return ""


def _descriptor(name: str, declared: _Declared) -> Values:
    ranges = [{"from_value": 0, "to_value": _HIGHEST, "step": 1}] if declared.is_ranged else []
    return {
        "name": name,
        "type": declared.kind,
        "description": declared.description,
        "read_only": declared.read_only,
        "integer_range": ranges,
    }


def _listed(names: Iterable[str], prefixes: list[str], depth: int) -> Values:
    """Return the names under any of `prefixes` (all without one), `depth` levels deep at most (0: any)."""
    listed = [
        name
        for name in names
        if (not prefixes and _within(name, depth))
        or any(
            name == prefix or (name.startswith(f"{prefix}.") and _within(name[len(prefix) + 1 :], depth))
            for prefix in prefixes
        )
    ]
    return {"names": listed, "prefixes": sorted({name.rpartition(".")[0] for name in listed if "." in name})}


def _within(name: str, depth: int) -> bool:
    return not depth or name.count(".") < depth
