"""Writes the source of message fields' setters: which values a field accepts, and what it says of others.

Rules and texts are those of rosidl_generator_py 0.14.4 (ROS 2 Humble).
"""

from __future__ import annotations

from rclpy._interfaces.definitions import Field
from rclpy._interfaces.field_types import ARRAY_CODES, alias, is_numeric, is_packed, numpy_type, python_type

FLOAT_BOUND = 3.402823466e38
DOUBLE_BOUND = 1.7976931348623157e308


def setter(field: Field) -> list[str]:
    """Return the statements that check `value` and put it in the field's slot."""
    slot = f"self._{field.name}"
    if not field.is_nested:
        return [*_scalar_checks(field), f"{slot} = value"]
    condition, text = _elements_check(field)
    check = f"assert {condition}, {text!r}"
    if is_packed(field):
        fallback = f"_to_numpy(value, {numpy_type(field)!r})"
        return [
            *_ndarray_branch(field),
            check,
            f"packed = _pack(value, {ARRAY_CODES[field.base]!r}, {field.size})",
            f"{slot} = {fallback} if packed is None else packed",
        ]
    if is_numeric(field):
        return [*_array_branch(field), check, f"{slot} = _array({ARRAY_CODES[field.base]!r}, value)"]
    return [check, f"{slot} = value"]


def _ndarray_branch(field: Field) -> list[str]:
    dtype = numpy_type(field)
    array = f"The {field.name!r} numpy.ndarray() must have"
    return [
        "if _is_ndarray(value):",
        f"    assert value.dtype == {dtype!r}, \"{array} the dtype of 'numpy.{dtype}'\"",
        f'    assert value.size == {field.size}, "{array} a size of {field.size}"',
        f"    self._{field.name} = value",
        "    return",
    ]


def _array_branch(field: Field) -> list[str]:
    code = ARRAY_CODES[field.base]
    array = f"The {field.name!r} array.array() must have"
    lines = [
        "if isinstance(value, _array):",
        f"    assert value.typecode == {code!r}, \"{array} the type code of '{code}'\"",
    ]
    if field.maximum is not None:
        lines.append(f'    assert len(value) <= {field.maximum}, "{array} a size <= {field.maximum}"')
    return [*lines, f"    self._{field.name} = value", "    return"]


def _elements_check(field: Field) -> tuple[str, str]:
    """Return condition and text of the assertion on an array or sequence."""
    conditions, texts = ["_is_list(value)"], ["a set or sequence"]
    if field.bound is not None:
        conditions.append(f"all(len(val) <= {field.bound} for val in value)")
    if field.maximum is not None:
        conditions.append(f"len(value) <= {field.maximum}")
        texts.append(f"with length <= {field.maximum}")
    elif field.size is not None:
        conditions.append(f"len(value) == {field.size}")
        texts.append(f"with length {field.size}")
    if field.bound is not None:
        texts.append(f"and each string value not longer than {field.bound}")
    element = alias(field.base) if field.is_message else python_type(field)
    conditions.append(f"all(isinstance(v, {element}) for v in value)")
    texts.append(f"and each value of type '{python_type(field)}'")
    if field.base == "float":
        conditions.append(f"all({_float_range('val')} for val in value)")
    if field.base in ("float", "double"):
        bound = FLOAT_BOUND if field.base == "float" else DOUBLE_BOUND
        texts.append(f"and each {field.base} in [{-bound:f}, {bound:f}]")
    elif is_numeric(field):
        low, high, kind = _integer_range(field)
        conditions.append(f"all(val >= {low} and val <= {high} for val in value)")
        texts.append(f"and each {kind} in [{low}, {high}]")
    return " and ".join(conditions), f"The {field.name!r} field must be {' '.join(texts)}"


def _scalar_checks(field: Field) -> list[str]:
    must = f"The {field.name!r} field must be"
    if field.is_message:
        text = f"{must} a sub message of type '{python_type(field)}'"
        return [f"assert isinstance(value, {alias(field.base)}), {text!r}"]
    if field.bound is not None:
        text = f"{must} string value not longer than {field.bound}"
        return [f"assert _is_text(value) and len(value) <= {field.bound}, {text!r}"]
    if field.base == "octet":
        text = f"{must} of type 'bytes' or 'ByteString' with length 1"
        return [f"assert isinstance(value, (bytes, bytearray)) and len(value) == 1, {text!r}"]
    kind = python_type(field)
    lines = [f'assert isinstance(value, {kind}), "{must} of type {kind!r}"']
    if field.base == "float":
        text = f"{must} a float in [{-FLOAT_BOUND}, {FLOAT_BOUND}]"
        lines.append(f'assert {_float_range("value")}, "{text}"')
    elif kind == "int":
        low, high, name = _integer_range(field)
        lines.append(f'assert value >= {low} and value <= {high}, "{must} an {name} in [{low}, {high}]"')
    return lines


def _float_range(variable: str) -> str:
    # A double needs no such check: nothing finite is outside its range.
    return f"not ({variable} < -{FLOAT_BOUND} or {variable} > {FLOAT_BOUND}) or _isinf({variable})"


def _integer_range(field: Field) -> tuple[int, int, str]:
    if field.base.startswith("u"):
        return 0, 2 ** int(field.base[4:]) - 1, "unsigned integer"
    half = 2 ** (int(field.base[3:]) - 1)
    return -half, half - 1, "integer"
