"""Messages as plain data and as text."""

from __future__ import annotations

from array import array
from collections import OrderedDict
from typing import Any


def message_to_ordereddict(msg: Any, *, truncate_length: int | None = None) -> OrderedDict[str, Any]:
    """Return a message's fields in order; nested messages become dicts, arrays lists.

    Args:
        msg: the message.
        truncate_length: longest text and list; what is cut off shows as ``...``.
    """
    names = msg.get_fields_and_field_types()
    return OrderedDict((name, _plain(getattr(msg, name), truncate_length)) for name in names)


def message_to_yaml(msg: Any, *, truncate_length: int | None = None) -> str:
    """Return a message as block-style YAML, as ``ros2 topic echo`` prints it."""
    return "\n".join(_yaml_lines(message_to_ordereddict(msg, truncate_length=truncate_length), 0)) + "\n"


def message_to_csv(msg: Any, *, truncate_length: int | None = None) -> str:
    """Return the values of a message's fields in one line, separated by commas."""
    return ",".join(_leaves(message_to_ordereddict(msg, truncate_length=truncate_length)))


def _plain(value: Any, limit: int | None) -> Any:
    if hasattr(value, "get_fields_and_field_types"):
        return message_to_ordereddict(value, truncate_length=limit)
    if isinstance(value, str):
        return value if limit is None or len(value) <= limit else value[:limit] + "..."
    if isinstance(value, list | tuple | array) or hasattr(value, "tolist"):
        elements = list(value) if isinstance(value, list | tuple) else value.tolist()
        shown = [_plain(element, limit) for element in elements[:limit]]
        return [*shown, "..."] if limit is not None and len(elements) > limit else shown
    return value


def _yaml_lines(values: OrderedDict[str, Any], depth: int) -> list[str]:
    indent = "  " * depth
    lines = []
    for name, value in values.items():
        if isinstance(value, dict) and value:
            lines += [f"{indent}{name}:", *_yaml_lines(OrderedDict(value), depth + 1)]
        elif isinstance(value, list) and value:
            lines.append(f"{indent}{name}:")
            for element in value:
                lines += _yaml_element(element, indent)
        else:
            lines.append(f"{indent}{name}: {_yaml_scalar(value)}")
    return lines


def _yaml_element(element: Any, indent: str) -> list[str]:
    if not isinstance(element, dict) or not element:
        return [f"{indent}- {_yaml_scalar(element)}"]
    first, *rest = _yaml_lines(OrderedDict(element), 0)
    return [f"{indent}- {first}", *(f"{indent}  {line}" for line in rest)]


def _yaml_scalar(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict | list):
        return "{}" if isinstance(value, dict) else "[]"
    if isinstance(value, str) and value and value.replace("_", "").isalnum() and not value[0].isdigit():
        return value
    return repr(value)


def _leaves(value: Any) -> list[str]:
    if isinstance(value, dict):
        return [leaf for inner in value.values() for leaf in _leaves(inner)]
    if isinstance(value, list):
        return [leaf for inner in value for leaf in _leaves(inner)]
    return [value.decode("latin-1") if isinstance(value, bytes) else str(value)]
