"""What a field's IDL type is called in Python, in `array`, in numpy and by ``get_fields_and_field_types``."""

from __future__ import annotations

from rclpy._interfaces.definitions import Field

ARRAY_CODES = {
    "float": "f",
    "double": "d",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
}
"""IDL name of each kind of number -> its type code in `array` and `struct`."""

_PYTHON_TYPES = {"boolean": "bool", "octet": "bytes", "string": "str", "wstring": "str"}
_WIDTHS = {"b": 1, "h": 2, "i": 4, "q": 8, "f": 4, "d": 8}


def alias(full_name: str) -> str:
    """Return the name under which the source refers to another message class."""
    return "_" + full_name.replace("/", "_")


def python_type(field: Field) -> str:
    """Return the name of the Python type of a field's values or elements, as messages show it."""
    if field.is_message:
        return field.base.rpartition("/")[2]
    return _PYTHON_TYPES.get(field.base) or ("float" if field.base in ("float", "double") else "int")


def numpy_type(field: Field) -> str:
    """Return the name of the numpy dtype of a field of numbers."""
    return {"float": "float32", "double": "float64"}.get(field.base, field.base)


def is_numeric(field: Field) -> bool:
    """Whether the values or elements of the field are numbers."""
    return field.base in ARRAY_CODES


def is_packed(field: Field) -> bool:
    """Whether the field is a fixed-size array of numbers: numpy's, once looked at."""
    return field.size is not None and is_numeric(field)


def packed_size(field: Field) -> int:
    """Return the number of bytes of a fixed-size array of numbers."""
    return (field.size or 0) * _WIDTHS[ARRAY_CODES[field.base].lower()]


def type_text(field: Field) -> str:
    """Return a field's type as ``get_fields_and_field_types`` tells it, e.g. ``sequence<double, 3>``."""
    base = field.base
    if field.is_message:
        package, _, name = base.split("/")
        base = f"{package}/{name}"
    elif field.bound is not None:
        base = f"{base}<{field.bound}>"
    if field.size is not None:
        return f"{base}[{field.size}]"
    if not field.is_sequence:
        return base
    return f"sequence<{base}>" if field.maximum is None else f"sequence<{base}, {field.maximum}>"
