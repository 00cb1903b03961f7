"""Messages as plain data and as text."""

from __future__ import annotations

import sys
from array import array
from collections import OrderedDict
from importlib import import_module
from typing import Any

from rosidl_parser.definition import Array, BoundedSequence


def message_to_ordereddict(
    msg: Any, *, truncate_length: int | None = None, no_arr: bool = False, no_str: bool = False
) -> OrderedDict[str, Any]:
    """Return a message's fields in order; nested messages become dicts, arrays lists.

    A text or list that is longer than `truncate_length` is cut off and ends in ``...``. `no_arr`: show only type
    and length of arrays. `no_str`: show only the length of texts.
    """
    show = _Shown(truncate_length, no_arr, no_str)
    return OrderedDict(
        (name, show.field(msg, name, kind)) for name, kind in get_message_slot_types(msg).items()
    )


def message_to_yaml(
    msg: Any,
    *,
    truncate_length: int | None = None,
    no_arr: bool = False,
    no_str: bool = False,
    flow_style: bool = False,
) -> str:
    """Return a message as YAML, as ``ros2 topic echo`` prints it; in one line if `flow_style`."""
    yaml = import_module("yaml")  # loaded when it is needed only
    yaml.add_representer(
        OrderedDict,
        lambda dumper, data: dumper.represent_mapping("tag:yaml.org,2002:map", data.items()),
    )
    text: str = yaml.dump(
        message_to_ordereddict(msg, truncate_length=truncate_length, no_arr=no_arr, no_str=no_str),
        allow_unicode=True,
        width=sys.maxsize,
        default_flow_style=flow_style,
    )
    return text


def message_to_csv(
    msg: Any, *, truncate_length: int | None = None, no_arr: bool = False, no_str: bool = False
) -> str:
    """Return the values of a message's fields in one line, separated by commas."""
    return _leaves(msg, _Shown(truncate_length, no_arr, no_str))


def get_message_slot_types(msg: Any) -> OrderedDict[str, Any]:
    """Return the types of a message's fields, as `rosidl_parser.definition` describes them, by their names."""
    return OrderedDict(zip(msg.get_fields_and_field_types(), msg.SLOT_TYPES, strict=True))


class _Shown:
    """How values are shown."""

    def __init__(self, limit: int | None, no_arr: bool, no_str: bool) -> None:
        self.limit = limit
        self.no_arr = no_arr
        self.no_str = no_str

    def field(self, msg: Any, name: str, kind: Any) -> Any:
        """Return the value of a field as plain data."""
        value = getattr(msg, name)
        if self.no_arr and _elements(value) is not None:
            return _array_info(value, kind)
        return self.value(value)

    def value(self, value: Any) -> Any:
        """Return any value as plain data."""
        if hasattr(value, "get_fields_and_field_types"):
            return message_to_ordereddict(
                value, truncate_length=self.limit, no_arr=self.no_arr, no_str=self.no_str
            )
        if isinstance(value, bytes):
            return self.cut(value.decode("latin-1"))
        if isinstance(value, str):
            return self.text(value)
        elements = _elements(value)
        if elements is None:
            return value.item() if hasattr(value, "item") else value
        shown = [self.value(element) for element in elements[: self.limit]]
        return [*shown, "..."] if self.limit is not None and len(elements) > self.limit else shown

    def text(self, value: str) -> str:
        """Return a text."""
        return f"<string length: <{len(value)}>>" if self.no_str else self.cut(value)

    def cut(self, value: str) -> str:
        """Return the beginning of what is too long."""
        return value if self.limit is None or len(value) <= self.limit else value[: self.limit] + "..."


def _elements(value: Any) -> list[Any] | None:
    """Return the elements of an array; None: it is none."""
    if isinstance(value, list | tuple):
        return list(value)
    if isinstance(value, array) or hasattr(value, "tolist"):
        elements = value.tolist()
        return elements if isinstance(elements, list) else None  # numpy's numbers have it, too
    return None


def _array_info(value: Any, kind: Any) -> str:
    inner = kind.value_type
    name = getattr(inner, "typename", "")
    if hasattr(inner, "namespaced_name"):
        name = "/".join(inner.namespaced_name())
    name = name or ("wstring" if "WString" in type(inner).__name__ else "string")
    if isinstance(kind, Array):
        return f"<array type: {name}[{kind.size}]>"
    bound = f"[{kind.maximum_size}]" if isinstance(kind, BoundedSequence) else ""
    return f"<sequence type: {name}{bound}, length: {len(value)}>"


def _leaves(msg: Any, show: _Shown) -> str:
    lines = []
    for name, kind in get_message_slot_types(msg).items():
        value = getattr(msg, name)
        is_array = _elements(value) is not None
        lines.append(_array_info(value, kind) if is_array and show.no_arr else _leaf(value, show))
    return _joined(lines)


def _leaf(value: Any, show: _Shown) -> str:
    if _elements(value) is not None:
        shown = [_leaf(inner, show) for inner in value[: show.limit]]
        return _joined([*shown, "..."] if show.limit is not None and len(value) > show.limit else shown)
    if hasattr(value, "get_fields_and_field_types"):
        return _leaves(value, show)
    if isinstance(value, bytes) and show.limit is not None and len(value) > show.limit:
        value = value[: show.limit] + b"..."
    return show.text(value) if isinstance(value, str) else str(value)


def _joined(texts: list[str]) -> str:
    """Return texts with commas between them; as upstream, there is none behind a beginning that is empty."""
    joined = ""
    for text in texts:
        joined += f",{text}" if joined else text
    return joined
