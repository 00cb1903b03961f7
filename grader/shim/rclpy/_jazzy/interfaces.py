"""Interface classes as rosidl_generator_py 0.22 writes them, and the definitions that Humble has not.

Fields take anything, unless ``ROS_PYTHON_CHECK_FIELDS=1`` is set or ``check_fields=True`` is given; services have
an `Event` (service introspection). What was built ahead for Humble is forgotten.
"""

from __future__ import annotations

import os
import sys

from rclpy._interfaces import cdr, cdr_source, definitions, importer, message_source, messages, own
from rclpy._interfaces.definitions import Field, Structure
from rclpy._interfaces.field_types import is_packed
from rclpy._jazzy.overlay import extends, replace
from rclpy._process.shelf import shelf

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_humble_constructor = message_source._constructor
_humble_setter = message_source.setter
_humble_slots = message_source._slots
_humble_structures = definitions.Interface.structures
_humble_define_service = messages._define_service


@extends(definitions.Interface)
class Interface(definitions.Interface):
    """Has the event of each of its services, too."""

    def structures(self) -> list[Structure]:
        """Parse the structures it consists of, in order of definition."""
        found = _humble_structures(self)
        if self.kind != "msg":
            suffix = "_Response"
            services = [s.full_name.removesuffix(suffix) for s in found if s.name.endswith(suffix)]
            found += [_event_of(service) for service in services]
        return found


def _event_of(service: str) -> Structure:
    event = Structure(f"{service}_Event")
    event.fields = [
        Field("info", "service_msgs/msg/ServiceEventInfo", None),
        Field("request", f"{service}_Request[<=1]", None),
        Field("response", f"{service}_Response[<=1]", None),
    ]
    return event


def _define_service(interface: definitions.Interface, name: str, namespace: dict[str, Any]) -> None:
    _humble_define_service(interface, name, namespace)
    namespace[name].Event = namespace[f"{name}_Event"]


def _slots(fields: list[Field]) -> list[str]:
    return [*_humble_slots(fields), "_check_fields"]


def _constructor(fields: list[Field]) -> list[str]:
    head, *rest = _humble_constructor(fields)
    checks = "    if self._check_fields:"
    return [
        head,
        "        self._check_fields = kwargs.get('check_fields', ros_python_check_fields == '1')",
        *(f"    {checks} {line.strip()}" if "_check_arguments" in line else line for line in rest),
    ]


def setter(field: Field) -> list[str]:
    """Return the statements that check `value` if that is wanted, and put it in the field's slot."""
    lines = _humble_setter(field)
    stored = 2 if is_packed(field) else 1
    checks = [f"    {line}" for line in lines[:-stored]]
    return ["if self._check_fields:", *checks, *lines[-stored:]]


class UncheckedEncoderSource(cdr_source.EncoderSource):
    """Source of an encoder that cuts whole numbers to their fields' sizes, as the cast in C does."""

    def _number(self, field: Field, code: str, target: str) -> tuple[str, str]:
        bits = field.base.removeprefix("u").removeprefix("int")
        if bits.isdecimal():
            return code.upper(), f"{target} & {(1 << int(bits)) - 1}"
        return super()._number(field, code, target)


def _new(cls: type) -> Any:
    message: Any = object.__new__(cls)
    message._check_fields = messages._SUPPORT["ros_python_check_fields"] == "1"
    return message


def _forget(packages: set[str]) -> None:
    """Have the interface classes built anew when they are asked for."""
    for name in [name for name in sys.modules if name.partition(".")[0] in packages]:
        del sys.modules[name]
    shelf.forget([name for name in shelf.names() if name.partition(".")[0] in packages])
    for name in [name for name, value in vars(own).items() if isinstance(value, messages.InterfaceType)]:
        delattr(own, name)
    for built in (
        messages.STRUCTURES,
        messages.CLASSES,
        importer._by_module,
        cdr._PACKERS,
        cdr._UNPACKERS,
        cdr._DECODERS,
        cdr._ELEMENT_ENCODERS,
        cdr._ELEMENT_DECODERS,
    ):
        built.clear()


_forget(importer.PACKAGES)
importer.include(definitions.load("jazzy"))
messages._SUPPORT["ros_python_check_fields"] = os.environ.get("ROS_PYTHON_CHECK_FIELDS", "")
messages._SUPPORT["getenv"] = os.getenv
cdr._READ_NAMES["new"] = _new
replace(messages, _define_service=_define_service)
replace(message_source, _slots=_slots, _constructor=_constructor, setter=setter)
replace(cdr, EncoderSource=UncheckedEncoderSource)
