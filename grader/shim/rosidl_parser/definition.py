"""Descriptions of field types, with the names and attributes of rosidl_parser.definition (ROS 2 Humble)."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

FLOATING_POINT_TYPES = ("float", "double", "long double")
CHARACTER_TYPES = ("char", "wchar")
BOOLEAN_TYPE = "boolean"
OCTET_TYPE = "octet"
SIGNED_NONEXPLICIT_INTEGER_TYPES = ("short", "long", "long long")
UNSIGNED_NONEXPLICIT_INTEGER_TYPES = ("unsigned short", "unsigned long", "unsigned long long")
NONEXPLICIT_INTEGER_TYPES = (*SIGNED_NONEXPLICIT_INTEGER_TYPES, *UNSIGNED_NONEXPLICIT_INTEGER_TYPES)
SIGNED_EXPLICIT_INTEGER_TYPES = ("int8", "int16", "int32", "int64")
UNSIGNED_EXPLICIT_INTEGER_TYPES = ("uint8", "uint16", "uint32", "uint64")
EXPLICIT_INTEGER_TYPES = (*SIGNED_EXPLICIT_INTEGER_TYPES, *UNSIGNED_EXPLICIT_INTEGER_TYPES)
SIGNED_INTEGER_TYPES = (*SIGNED_NONEXPLICIT_INTEGER_TYPES, *SIGNED_EXPLICIT_INTEGER_TYPES)
UNSIGNED_INTEGER_TYPES = (*UNSIGNED_NONEXPLICIT_INTEGER_TYPES, *UNSIGNED_EXPLICIT_INTEGER_TYPES)
INTEGER_TYPES = (*SIGNED_INTEGER_TYPES, *UNSIGNED_INTEGER_TYPES)
BASIC_TYPES = (*INTEGER_TYPES, *FLOATING_POINT_TYPES, *CHARACTER_TYPES, BOOLEAN_TYPE, OCTET_TYPE)


class AbstractType:
    """Root of all types. Two types are equal when their class and all their attributes are."""

    __slots__: tuple[str, ...] = ()

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and all(
            getattr(self, slot) == getattr(other, slot)
            for owner in type(self).__mro__
            for slot in getattr(owner, "__slots__", ())
        )

    __hash__ = None  # type: ignore[assignment]


class _Bounded:
    __slots__ = ()

    def has_maximum_size(self) -> bool:
        """Whether the size is bounded."""
        return True


class _Unbounded:
    __slots__ = ()

    def has_maximum_size(self) -> bool:
        """Whether the size is bounded."""
        return False


class AbstractNestableType(AbstractType):
    """A type that can be the element of an array or sequence."""

    __slots__ = ()


class BasicType(AbstractNestableType):
    """A number, boolean or octet."""

    __slots__ = ("typename",)

    def __init__(self, typename: str) -> None:
        assert typename in BASIC_TYPES
        self.typename = typename


class NamedType(AbstractNestableType):
    """A type known by a name not yet resolved."""

    __slots__ = ("name",)

    def __init__(self, name: str) -> None:
        self.name = name


class NamespacedType(AbstractNestableType):
    """Another structure, e.g. ``NamespacedType(['geometry_msgs', 'msg'], 'Vector3')``."""

    __slots__ = ("name", "namespaces")

    def __init__(self, namespaces: Iterable[str], name: str) -> None:
        self.namespaces = namespaces
        self.name = name

    def namespaced_name(self) -> tuple[str, ...]:
        """Return namespaces and name in one tuple."""
        return (*self.namespaces, self.name)


class AbstractGenericString(AbstractNestableType):
    """Any string."""

    __slots__ = ()

    def has_maximum_size(self) -> bool:
        """Whether the string is bounded."""
        raise NotImplementedError("Only implemented in subclasses")


class AbstractString(AbstractGenericString):
    """Any string of 8-bit characters."""

    __slots__ = ()


class AbstractWString(AbstractGenericString):
    """Any string of 16-bit characters."""

    __slots__ = ()


class BoundedString(_Bounded, AbstractString):
    """A string of at most `maximum_size` characters."""

    __slots__ = ("maximum_size",)

    def __init__(self, maximum_size: int) -> None:
        assert maximum_size >= 0
        self.maximum_size = maximum_size


class UnboundedString(_Unbounded, AbstractString):
    """A string of any length."""

    __slots__ = ()


class BoundedWString(_Bounded, AbstractWString):
    """A wide string of at most `maximum_size` characters."""

    __slots__ = ("maximum_size",)

    def __init__(self, maximum_size: int) -> None:
        self.maximum_size = maximum_size


class UnboundedWString(_Unbounded, AbstractWString):
    """A wide string of any length."""

    __slots__ = ()


class AbstractNestedType(AbstractType):
    """Any type with elements."""

    __slots__ = ("value_type",)

    def __init__(self, value_type: AbstractNestableType) -> None:
        assert isinstance(value_type, AbstractNestableType)
        self.value_type = value_type

    def has_maximum_size(self) -> bool:
        """Whether the number of elements is bounded."""
        raise NotImplementedError("Only implemented in subclasses")


class Array(_Bounded, AbstractNestedType):
    """Exactly `size` elements."""

    __slots__ = ("size",)

    def __init__(self, value_type: AbstractNestableType, size: int) -> None:
        super().__init__(value_type)
        assert size > 0
        self.size = size


class AbstractSequence(AbstractNestedType):
    """Any number of elements."""

    __slots__ = ()


class BoundedSequence(_Bounded, AbstractSequence):
    """At most `maximum_size` elements."""

    __slots__ = ("maximum_size",)

    def __init__(self, value_type: AbstractNestableType, maximum_size: int) -> None:
        super().__init__(value_type)
        assert maximum_size > 0
        self.maximum_size = maximum_size


class UnboundedSequence(_Unbounded, AbstractSequence):
    """Any number of elements, without a bound."""

    __slots__ = ()
