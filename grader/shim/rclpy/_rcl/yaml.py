"""The part of YAML that parameter files and ``-p name:=value`` use: mappings, lists and plain scalars."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_TRUE = frozenset(("Y", "y", "yes", "Yes", "YES", "true", "True", "TRUE", "on", "On", "ON"))
_FALSE = frozenset(("N", "n", "no", "No", "NO", "false", "False", "FALSE", "off", "Off", "OFF"))
_SPECIAL = {
    sign + spelling: (-1.0 if sign == "-" else 1.0) * float(spelling[1:].lower())
    for sign in ("", "+", "-")
    for spelling in (".inf", ".Inf", ".INF")
} | {spelling: float("nan") for spelling in (".nan", ".NaN", ".NAN")}


def parse_scalar(text: str) -> Any:
    """Return the value of one scalar by the rules of rcl_yaml_param_parser (strtoll, then strtod, then text)."""
    text = text.strip()
    if len(text) >= 2 and text[0] == text[-1] and text[0] in "'\"":
        return _unquote(text)
    if text in _TRUE or text in _FALSE:
        return text in _TRUE
    for read in (_read_int, _read_float):
        value = read(text)
        if value is not None:
            return value
    return text


def _unquote(text: str) -> str:
    body = text[1:-1]
    if text[0] == "'":
        return body.replace("''", "'")
    return body.replace('\\"', '"').replace("\\n", "\n").replace("\\t", "\t").replace("\\\\", "\\")


def _read_int(text: str) -> int | None:
    digits = text.lstrip("+-")
    base = 16 if digits[:2] in ("0x", "0X") else 8 if digits[:1] == "0" and len(digits) > 1 else 10
    try:
        value = int(text, base) if "_" not in text else None
    except ValueError:
        try:
            value = int(text.replace("0", "0o", 1), 8) if base == 8 else None
        except ValueError:
            return None
    if value is None or not -(1 << 63) <= value < 1 << 63:
        return None
    return value


def _read_float(text: str) -> float | None:
    if text in _SPECIAL:
        return _SPECIAL[text]
    try:
        return float(text) if "_" not in text else None
    except ValueError:
        return None


def parse_value(text: str) -> Any:
    """Return the value after ``:=``: a scalar or a flow list.

    Raises:
        ValueError: a list is not closed.
    """
    text = text.strip()
    if not text.startswith("["):
        return parse_scalar(text)
    if not text.endswith("]"):
        raise ValueError(f"list is not closed: {text}")
    return _one_type([parse_scalar(item) for item in _split_items(text[1:-1])])


def _one_type(items: list[Any]) -> list[Any]:
    kinds = {type(item) for item in items}
    if kinds == {int, float}:
        return [float(item) for item in items]
    if len(kinds) > 1:
        raise ValueError("Sequence should be of same type")
    return items


def _split_items(text: str) -> list[str]:
    items, quote, start = [], "", 0
    for i, character in enumerate(text):
        if quote:
            quote = "" if character == quote else quote
        elif character in "'\"":
            quote = character
        elif character == ",":
            items.append(text[start:i])
            start = i + 1
    items.append(text[start:])
    return [item for item in items if item.strip()]


def parse_document(text: str) -> dict[str, Any]:
    """Return the mapping a parameter file holds.

    Raises:
        ValueError: the text is outside the supported part of YAML.
    """
    lines = []
    for raw in text.splitlines():
        stripped = _without_comment(raw).rstrip()
        if stripped.strip() and stripped.strip() not in ("---", "..."):
            if "\t" in stripped[: len(stripped) - len(stripped.lstrip())]:
                raise ValueError(f"tab in indentation: {raw!r}")
            lines.append((len(stripped) - len(stripped.lstrip()), stripped.strip()))
    value, rest = _parse_block(lines, 0)
    if rest != len(lines) or not isinstance(value, dict):
        raise ValueError("not a mapping of nodes")
    return value


def _without_comment(line: str) -> str:
    quote = ""
    for i, character in enumerate(line):
        if quote:
            quote = "" if character == quote else quote
        elif character in "'\"":
            quote = character
        elif character == "#" and (i == 0 or line[i - 1] in " \t"):
            return line[:i]
    return line


def _parse_block(lines: list[tuple[int, str]], at: int) -> tuple[Any, int]:
    if at >= len(lines):
        return {}, at
    indent = lines[at][0]
    if lines[at][1].startswith("- ") or lines[at][1] == "-":
        items = []
        while at < len(lines) and lines[at][0] == indent and lines[at][1].startswith("-"):
            items.append(parse_scalar(lines[at][1][1:]))
            at += 1
        return _one_type(items), at
    mapping: dict[str, Any] = {}
    while at < len(lines) and lines[at][0] == indent:
        key, value = _split_key(lines[at][1])
        at += 1
        if value:
            mapping[key] = parse_value(value)
        elif at < len(lines) and (lines[at][0] > indent or lines[at][1].startswith("- ")):
            mapping[key], at = _merge(mapping.get(key), *_parse_block(lines, at))
        else:
            mapping[key] = ""
    return mapping, at


def _merge(old: Any, new: Any, at: int) -> tuple[Any, int]:
    """Join repeated keys: parameter files may name a node twice."""
    return ({**old, **new} if isinstance(old, dict) and isinstance(new, dict) else new), at


def _split_key(line: str) -> tuple[str, str]:
    if line[0] in "'\"":
        end = line.index(line[0], 1)
        key, rest = line[1:end], line[end + 1 :].lstrip()
        if not rest.startswith(":"):
            raise ValueError(f"not a 'key: value' line: {line!r}")
        return key, rest[1:].strip()
    key, colon, value = line.partition(": ") if ": " in line else line.rpartition(":")
    if not colon or (not value.strip() and not line.endswith(":")):
        raise ValueError(f"not a 'key: value' line: {line!r}")
    return key.strip(), value.strip()
