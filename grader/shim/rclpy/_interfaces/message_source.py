"""Writes the Python source of message classes, with the rules of rosidl_generator_py 0.14.4 (ROS 2 Humble).

What a student can notice is the same as there: keyword-only constructors, slots, defaults, which values a
field accepts, and the texts of the assertions. Two things differ: an object built without arguments skips
the checks its defaults would pass anyway, and a fixed-size array of numbers stays bytes inside the message
until somebody looks at it, so that a script that never does does not pay for importing numpy.
"""

from __future__ import annotations

from rclpy._interfaces.definitions import Field, Structure
from rclpy._interfaces.field_types import (
    ARRAY_CODES,
    alias,
    is_numeric,
    is_packed,
    numpy_type,
    packed_size,
    python_type,
    type_text,
)

FLOAT_BOUND = 3.402823466e38
DOUBLE_BOUND = 1.7976931348623157e308

_ZEROS = {
    "boolean": "False",
    "octet": "b'\\x00'",
    "string": "''",
    "wstring": "''",
    "float": "0.0",
    "double": "0.0",
}


def class_source(structure: Structure) -> str:
    """Return the definition of the message class of a structure."""
    name, fields = structure.name, structure.fields
    lines = [f"class {name}(metaclass=Metaclass_{name}):", *_docstring(structure)]
    lines.append(f"    __slots__ = {_slots(fields)!r}")
    lines.append(f"    _fields_and_field_types = { {field.name: type_text(field) for field in fields}!r}")
    lines.append(f"    SLOT_TYPES = _slot_types_{name}")
    lines += [f"    {constant} = {value}" for constant, value in structure.constants]
    lines += [_default_attribute(field) for field in fields if field.default is not None]
    lines += _constructor(fields)
    lines += _equality(fields)
    lines += ["    __repr__ = _message_repr", "    get_fields_and_field_types = _get_fields_and_field_types"]
    for field in fields:
        lines += _property(field)
    return "\n".join(lines) + "\n"


def _slots(fields: list[Field]) -> list[str]:
    return ["_" + field.name for field in fields]


def default_source(field: Field) -> str:
    """Return the expression of a field's default as an attribute of class and metaclass."""
    if is_packed(field):
        return f"_to_numpy({field.default}, {numpy_type(field)!r})"
    if field.is_sequence and is_numeric(field):
        return f"_array({ARRAY_CODES[field.base]!r}, {field.default})"
    return str(field.default)


def _docstring(structure: Structure) -> list[str]:
    if not structure.constants:
        return [f'    """Message class {structure.name!r}."""']
    names = [f"      {name}" for name, _ in structure.constants]
    return ['    """', f"    Message class {structure.name!r}.", "", "    Constants:", *names, '    """']


def _default_attribute(field: Field) -> str:
    attribute = f"{field.name.upper()}__DEFAULT"
    if is_packed(field):  # looked up on the class, so that numpy is not imported to define it
        return f"    {attribute} = _property(lambda self: type(self).{attribute})"
    return f"    {attribute} = {default_source(field)}"


def _initial(field: Field) -> str:
    """Return the expression of what a slot holds when its field is not given."""
    if is_packed(field):
        if field.default is None:
            return f"bytes({packed_size(field)})"
        return f"_array({ARRAY_CODES[field.base]!r}, {field.default}).tobytes()"
    if field.default is not None:
        return default_source(field)
    if field.is_sequence:
        return f"_array({ARRAY_CODES[field.base]!r})" if is_numeric(field) else "[]"
    if field.is_message:
        single = f"{alias(field.base)}()"
        return single if field.size is None else f"[{single} for _ in range({field.size})]"
    zero = _ZEROS.get(field.base, "0")
    return zero if field.size is None else f"[{zero}] * {field.size}"


def _constructor(fields: list[Field]) -> list[str]:
    lines = ["    def __init__(self, **kwargs):"]
    lines += [f"        self._{field.name} = {_initial(field)}" for field in fields]
    lines += ["        if not kwargs:", "            return", "        _check_arguments(self, kwargs)"]
    for field in fields:
        lines += [
            f"        if {field.name!r} in kwargs:",
            *(f"            {line}" for line in _assignment(field)),
        ]
    return lines


def _assignment(field: Field) -> list[str]:
    """Return the statements of a constructor that set a field from its argument."""
    argument = f"kwargs[{field.name!r}]"
    if field.default is not None or not (is_numeric(field) and field.is_nested):
        return [f"self.{field.name} = {argument}"]
    code = ARRAY_CODES[field.base]
    if field.is_sequence:
        return [f"self.{field.name} = _array({code!r}, {argument})"]
    return [
        f"self._{field.name} = _pack({argument}, {code!r}, {field.size})",
        f"if self._{field.name} is None:",
        f"    self.{field.name} = _to_numpy({argument}, {numpy_type(field)!r})",
        f"    assert self.{field.name}.shape == ({field.size}, )",
    ]


def _equality(fields: list[Field]) -> list[str]:
    lines = [
        "    def __eq__(self, other):",
        "        if not isinstance(other, self.__class__):",
        "            return False",
    ]
    for field in fields:
        differ = f"self.{field.name} != other.{field.name}"
        # Humble's own rule: arrays differ only if all their elements do.
        lines += [f"        if all({differ}):" if is_packed(field) else f"        if {differ}:"]
        lines += ["            return False"]
    return [*lines, "        return True"]


def _property(field: Field) -> list[str]:
    name = field.name
    getter = f"_getter('_{name}')"
    if is_packed(field):
        getter = f"_array_getter('_{name}', {ARRAY_CODES[field.base]!r}, {numpy_type(field)!r})"
    return [
        f"    def {name}(self, value):",
        *(f"        {line}" for line in setter(field)),
        f"    {name} = _property({getter}, {name}, None, \"Message field '{name}'.\")",
    ]


# Setters: which values a field accepts, and what it says of others -------------------------------------


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
        code = ARRAY_CODES[field.base]
        fits = "" if field.maximum is None else f" and len(value) <= {field.maximum}"
        quick = [f"if type(value) is list{fits}:", f"    value = _converted(value, {code!r})"]
        return [*quick, *_array_branch(field), check, f"{slot} = _array({code!r}, value)"]
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
    if ARRAY_CODES.get(field.base) == "B":  # of a picture's million bytes each is what the check asks for
        conditions[-2:] = [f"(type(value) is bytes or {conditions[-2]} and {conditions[-1]})"]
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
