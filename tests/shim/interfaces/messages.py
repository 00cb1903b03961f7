"""Random messages of every type the student side knows, and their form in rosbags."""

import importlib
from array import array
from typing import Any

import numpy as np
from hypothesis import strategies as st
from rclpy._interfaces.definitions import INTERFACES, Field
from rclpy._interfaces.field_types import ARRAY_CODES, numpy_type
from rclpy._interfaces.messages import CLASSES, STRUCTURES

for _interface in INTERFACES.values():
    importlib.import_module(_interface.module)

NAMES = sorted(CLASSES)
TEXT = st.text(st.characters(exclude_characters="\0", exclude_categories=["Cs"]), max_size=6)


def messages(names: list[str] = NAMES) -> st.SearchStrategy[Any]:
    """Return a strategy for messages of the named types."""
    return st.sampled_from(names).flatmap(message_of)


def message_of(name: str) -> st.SearchStrategy[Any]:
    """Return a strategy for messages of one type."""
    fields = STRUCTURES[CLASSES[name]].fields
    return st.builds(CLASSES[name], **{field.name: _values(field) for field in fields})


def _values(field: Field) -> st.SearchStrategy[Any]:
    if not field.is_nested:
        return _single(field)
    low, high = (field.size, field.size) if field.size is not None else (0, min(field.maximum or 3, 3))
    return st.lists(_single(field), min_size=low, max_size=high)


def _single(field: Field) -> st.SearchStrategy[Any]:
    if field.is_message:
        # Most of test_msgs' nesting would only repeat what shallower messages show.
        return st.builds(CLASSES[field.base]) if "test_msgs" in field.base else message_of(field.base)
    if field.base == "float":
        # Humble's bound lies just below the largest float32.
        return st.floats(-(2.0**127), 2.0**127, width=32)
    if field.base in ARRAY_CODES and field.base != "double":
        bits, low = int(field.base.lstrip("uint")), 0 if field.base.startswith("u") else -1
        return st.integers(low * 2 ** (bits - 1), 2 ** (bits + low) - 1)
    return {
        "boolean": st.booleans(),
        "octet": st.binary(min_size=1, max_size=1),
        "double": st.floats(allow_nan=False),
        "string": TEXT,
        "wstring": TEXT,
    }[field.base]


def to_rosbags(message: Any, store: Any) -> Any:
    """Return rosbags' own object for `message`."""
    structure = STRUCTURES[type(message)]
    values = {
        field.name: _to_rosbags(field, getattr(message, field.name), store) for field in structure.fields
    }
    if not values:
        values["structure_needs_at_least_one_member"] = 0
    return store.types[structure.full_name](**values)


def _to_rosbags(field: Field, value: Any, store: Any) -> Any:
    if field.is_message:
        if field.is_nested:
            return [to_rosbags(element, store) for element in value]
        return to_rosbags(value, store)
    if field.base == "octet":
        # it packs a lone octet as a signed number: the same bits
        return np.frombuffer(b"".join(value), np.uint8) if field.is_nested else int.from_bytes(value, signed=True)
    if field.base == "boolean" and field.is_nested:
        return np.array(value, bool)
    return np.array(value, numpy_type(field)) if isinstance(value, array) else value
