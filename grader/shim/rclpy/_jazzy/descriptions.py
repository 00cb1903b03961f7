"""Descriptions of interface types and their hashes, as rosidl_generator_type_description makes them (REP 2016)."""

from __future__ import annotations

from rclpy._interfaces.definitions import INTERFACES, Field, Structure
from rclpy.type_hash import TypeHash

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_NUMBERS = (
    *("", "message", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float"),
    *("double", "long double", "char", "wchar", "boolean", "octet", "string", "wstring"),
)
"""Names of types in the order of the constants of type_description_interfaces/msg/FieldType."""

_BOUNDED_TEXT = 4  # from a string's number to that of a bounded one
_ARRAY, _BOUNDED, _UNBOUNDED = 48, 96, 144  # added to the number of an element's type
_VERSION = 1

_hashes: dict[str, TypeHash] = {}


def structures_of(type_name: str) -> list[Structure]:
    """Return the structures of the interface that a type belongs to; KeyError when there is none."""
    package, kind, name = type_name.split("/")
    for suffix in (
        "",
        "_Request",
        "_Response",
        "_Event",
        "_Goal",
        "_Result",
        "_FeedbackMessage",
        "_Feedback",
    ):
        owner = INTERFACES.get(f"{package}/{kind}/{name.removesuffix(suffix) if suffix else name}")
        if owner is not None:
            return owner.structures()
    raise KeyError(type_name)


def describe(type_name: str) -> dict[str, Any]:
    """Return a type's description in the form that is hashed; KeyError when there is no such type."""
    described: dict[str, dict[str, Any]] = {}
    _add(type_name, described)
    own = described.pop(type_name)
    return {
        "type_description": own,
        "referenced_type_descriptions": [described[name] for name in sorted(described)],
    }


def _add(type_name: str, described: dict[str, dict[str, Any]]) -> None:
    fields = [{"name": field.name, "type": _field_type(field)} for field in _structure(type_name).fields] or [
        {"name": "structure_needs_at_least_one_member", "type": _field_type(Field("", "uint8", None))}
    ]
    described[type_name] = {"type_name": type_name, "fields": fields}
    for field in fields:
        nested = field["type"]["nested_type_name"]  # type: ignore[index]
        if nested and nested not in described:
            _add(nested, described)


def _structure(type_name: str) -> Structure:
    structures = {structure.full_name: structure for structure in structures_of(type_name)}
    if type_name in structures:
        return structures[type_name]
    service = Structure(type_name)  # of a service itself: its three messages
    for part in ("request", "response", "event"):
        service.fields.append(Field(f"{part}_message", f"{type_name}_{part.capitalize()}", None))
    return service


def _field_type(field: Field) -> dict[str, Any]:
    number = _NUMBERS.index("message" if field.is_message else field.base)
    if field.bound is not None:
        number += _BOUNDED_TEXT
    if field.size is not None:
        number += _ARRAY
    elif field.is_sequence:
        number += _UNBOUNDED if field.maximum is None else _BOUNDED
    return {
        "type_id": number,
        "capacity": field.size or field.maximum or 0,
        "string_capacity": field.bound or 0,
        "nested_type_name": field.base if field.is_message else "",
    }


def hash_of(type_name: str) -> TypeHash:
    """Return the hash of a message or service type."""
    if type_name not in _hashes:
        import json
        from hashlib import sha256

        text = json.dumps(describe(type_name), separators=(", ", ": "))
        _hashes[type_name] = TypeHash(_VERSION, sha256(text.encode()).digest())
    return _hashes[type_name]
