"""Writes the Python source of a message class's CDR encoder and decoder.

Runs of fields of fixed size become one call of `struct`, with the padding worked out beforehand as far as the
position is known. It is known modulo 8 at the start of a message, modulo 4 after a sequence's length, and not
at all after a string or inside a sequence of structures; there the generated code aligns as it runs.
"""

from __future__ import annotations

from struct import Struct

from rclpy._interfaces.definitions import Field, Structure
from rclpy._interfaces.field_types import ARRAY_CODES, alias, is_numeric, is_packed, packed_size
from rclpy._interfaces.messages import CLASSES, STRUCTURES

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_CODES = {**ARRAY_CODES, "boolean": "?", "octet": "c"}
_WIDTHS = {code: Struct("<" + code).size for code in _CODES.values()}


class _Source:
    """Source under way: finished lines, the run of fixed-size fields not yet written, and the position.

    Attributes:
        names: globals the source refers to.
        is_one_run: every field so far has a fixed size, and nothing is written yet.
    """

    def __init__(self, names: dict[str, Any], aligned: bool) -> None:
        self.names = names
        self.lines: list[str] = []
        self._codes = ""
        self._terms: list[str] = []
        self._modulus = 8 if aligned else 1
        self._offset = 0
        self._locals = 0
        self.is_one_run = True

    def local(self) -> str:
        """Return a fresh local variable."""
        self._locals += 1
        return f"v{self._locals}"

    def put(self, width: int, code: str, term: str | None = None, size: int | None = None) -> None:
        """Append a field of fixed size (default `width`) aligned to `width` to the run."""
        if self._modulus < width:
            self.flush()
            self.lines.append(self._align(width))
            self._modulus, self._offset = width, 0
        padding = -self._offset % width
        self._codes += "x" * padding + code
        self._offset = (self._offset + padding + (width if size is None else size)) % self._modulus
        if term is not None:
            self._terms.append(term)

    def flush(self) -> None:
        """Write the run as one call of `struct`."""
        self.is_one_run = False
        if self._codes:
            layout = f"s{len(self.names)}"
            self.names[layout] = Struct("<" + self._codes)
            self.lines.append(self._move(layout, self._terms))
            self._codes, self._terms = "", []

    def with_header(self) -> tuple[str, str, int]:
        """Return the run, behind a header, as the name of its struct, its terms, and its size in bytes."""
        layout = Struct("<4s" + self._codes)
        self.names["whole"] = layout
        return "whole", ", ".join(self._terms), layout.size

    def lose(self, width: int = 1) -> None:
        """Note that from here on the position is only known to be a multiple of `width`."""
        self._modulus, self._offset = width, 0

    def structure(self, structure: Structure, owner: str) -> None:
        """Append all fields of the structure that the variable `owner` holds."""
        if not structure.fields:
            self.put(1, "x")
        for field in structure.fields:
            target = f"{owner}._{field.name}"
            if field.is_message:
                self.names[alias(field.base)] = CLASSES[field.base]
            if not field.is_nested:
                self._single(field, target)
            elif is_packed(field):
                code = ARRAY_CODES[field.base]
                size = packed_size(field)
                self.put(_WIDTHS[code], f"{size}s", self._packed(target, size), size)
            else:
                self._several(field, target)

    def _single(self, field: Field, target: str) -> None:
        if field.is_message:
            self._nested(field, target)
        elif field.base in ("string", "wstring"):
            self._text(field, target)
        else:
            code = _CODES[field.base]
            self.put(_WIDTHS[code], *self._number(field, code, target))

    def _number(self, field: Field, code: str, target: str) -> tuple[str, str]:
        """Return type code and term of a field of one number, octet or truth value."""
        return code, f"bytes({target})" if self._copies(field) else target

    def _several(self, field: Field, target: str) -> None:
        """Append an array or sequence through the runtime function of its kind."""
        raise NotImplementedError

    def _nested(self, field: Field, target: str) -> None:
        raise NotImplementedError

    def _text(self, field: Field, target: str) -> None:
        raise NotImplementedError

    def _align(self, width: int) -> str:
        raise NotImplementedError

    def _move(self, layout: str, terms: list[str]) -> str:
        raise NotImplementedError

    def _packed(self, target: str, size: int) -> str:
        raise NotImplementedError

    def _copies(self, field: Field) -> bool:
        raise NotImplementedError


def _element(field: Field) -> str:
    """Return the name of the runtime function for the elements of an array or sequence."""
    if field.is_message:
        return "messages"
    return {"boolean": "booleans", "octet": "octets", "string": "texts", "wstring": "wide_texts"}.get(
        field.base, "numbers"
    )


def _arguments(field: Field) -> str:
    """Return what the runtime function needs to know of the elements."""
    if field.is_message:
        return f", {alias(field.base)}"
    if is_numeric(field):
        return f", {ARRAY_CODES[field.base]!r}"
    return f", {field.bound}" if field.base in ("string", "wstring") else ""


def _width_after(field: Field) -> int:
    """Return what the position is a multiple of after the field's elements."""
    return min(4, _WIDTHS[ARRAY_CODES[field.base]]) if is_numeric(field) else 1


class EncoderSource(_Source):
    """Source of ``write(m, out)``, which appends message `m` to the bytearray `out`."""

    def _several(self, field: Field, target: str) -> None:
        value = self.local()
        self.lines.append(f"{value} = {target}")
        if field.size is not None:
            self.lines.append(f"expect(len({value}) == {field.size}, {field.name!r})")
        else:
            if field.maximum is not None:
                self.lines.append(f"expect(len({value}) <= {field.maximum}, {field.name!r})")
            self.put(4, "I", f"len({value})")
        self.flush()
        self.lines.append(f"write_{_element(field)}(out, {value}{_arguments(field)})")
        self.lose(_width_after(field))

    def _nested(self, field: Field, target: str) -> None:
        value = self.local()
        self.lines.append(f"{value} = {target}")
        self.lines.append(f"if {value}.__class__ is not {alias(field.base)}: raise TypeError")
        self.structure(STRUCTURES[CLASSES[field.base]], value)

    def _text(self, field: Field, target: str) -> None:
        value = self.local()
        wide = "wide_" if field.base == "wstring" else ""
        self.lines.append(f"{value} = {wide}text_bytes({target}, {field.bound})")
        self.put(4, "I", f"len({value}) // 4" if wide else f"len({value})")
        self.flush()
        self.lines.append(f"out += {value}")
        self.lose(4 if wide else 1)

    def _align(self, width: int) -> str:
        return f"out += PADDING[(4 - len(out)) & {width - 1}]"

    def _move(self, layout: str, terms: list[str]) -> str:
        return f"out += {layout}.pack({', '.join(terms)})"

    def _packed(self, target: str, size: int) -> str:
        return f"packed_bytes({target}, {size})"

    def _copies(self, field: Field) -> bool:
        return field.base == "octet"  # a bytearray is allowed in the field, but not in struct


class DecoderSource(_Source):
    """Source of ``read(data, pos)``, which returns the message that begins at `pos` and where it ends."""

    def _several(self, field: Field, target: str) -> None:
        if field.size is not None:
            count = str(field.size)
        else:
            count = self.local()
            self.put(4, "I", count)
        self.flush()
        if field.maximum is not None:
            self.lines.append(f"expect({count} <= {field.maximum}, {field.name!r})")
        self.lines.append(f"{target}, pos = read_{_element(field)}(data, pos, {count}{_arguments(field)})")
        self.lose(_width_after(field))

    def _nested(self, field: Field, target: str) -> None:
        value = self.local()
        self.lines.append(f"{value} = {target} = new({alias(field.base)})")
        self.structure(STRUCTURES[CLASSES[field.base]], value)

    def _text(self, field: Field, target: str) -> None:
        length = self.local()
        self.put(4, "I", length)
        self.flush()
        wide = "wide_" if field.base == "wstring" else ""
        self.lines.append(f"{target}, pos = read_{wide}text(data, pos, {length}, {field.bound})")
        self.lose(4 if wide else 1)

    def _align(self, width: int) -> str:
        return f"pos += -pos & {width - 1}"

    def _move(self, layout: str, terms: list[str]) -> str:
        targets = f"{', '.join(terms)}, = " if terms else ""
        return f"{targets}{layout}.unpack_from(data, pos); pos += {layout}.size"

    def _packed(self, target: str, size: int) -> str:
        return target

    def _copies(self, field: Field) -> bool:
        return False
