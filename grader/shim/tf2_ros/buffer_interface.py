"""Transforming stamped objects between frames, and the registry of what can be transformed."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from typing import Any, ClassVar

from rclpy.duration import Duration
from rclpy.time import Time
from std_msgs.msg import Header

_NO_TIMEOUT = Duration()


class TypeException(Exception):
    """An object's type is not registered for transforming or converting."""

    def __init__(self, errstr: str) -> None:
        self.errstr = errstr


class NotImplementedException(Exception):
    """A buffer does not implement looking up."""

    def __init__(self) -> None:
        self.errstr = "CanTransform or LookupTransform not implemented"


class BufferInterface:
    """What a buffer offers on top of looking transforms up."""

    def __init__(self) -> None:
        self.registration = TransformRegistration()

    def transform(
        self, object_stamped: Any, target_frame: str, timeout: Duration = _NO_TIMEOUT, new_type: Any = None
    ) -> Any:
        """Return a stamped object in another frame, at its own time, converted to `new_type` if given.

        Raises TypeException: its type is not registered (importing `tf2_geometry_msgs` registers the usual).
        """
        do_transform = self.registration.get(type(object_stamped))
        header = object_stamped.header
        moved = do_transform(
            object_stamped,
            self.lookup_transform(target_frame, header.frame_id, header.stamp, timeout),
        )
        return moved if new_type is None else convert(moved, new_type)

    def transform_full(
        self,
        object_stamped: Any,
        target_frame: str,
        target_time: Time,
        fixed_frame: str,
        timeout: Duration = _NO_TIMEOUT,
        new_type: Any = None,
    ) -> Any:
        """Return a stamped object in another frame at another time, by way of a frame fixed in time.

        Raises TypeException: its type is not registered.
        """
        do_transform = self.registration.get(type(object_stamped))
        header = object_stamped.header
        looked_up = self.lookup_transform_full(
            target_frame, target_time, header.frame_id, header.stamp, fixed_frame, timeout
        )
        moved = do_transform(object_stamped, looked_up)
        return moved if new_type is None else convert(moved, new_type)

    def _not_implemented(self, *question: Any, **options: Any) -> Any:
        """Stand for what a buffer has to bring: looking up, and telling whether that would succeed."""
        raise NotImplementedException

    lookup_transform: Any = _not_implemented
    lookup_transform_full: Any = _not_implemented
    can_transform: Any = _not_implemented
    can_transform_full: Any = _not_implemented


def Stamped(obj: Any, stamp: Any, frame_id: str) -> Any:
    """Give an object a header."""
    obj.header = Header(frame_id=frame_id, stamp=stamp)
    return obj


class TransformRegistration:
    """What moves an object of a type by a TransformStamped; shared by all buffers."""

    _types: ClassVar[dict[Any, Callable[[Any, Any], Any]]] = {}

    def add(self, key: Any, callback: Callable[[Any, Any], Any]) -> None:
        """Register a type."""
        self._types[key] = callback

    def get(self, key: Any) -> Callable[[Any, Any], Any]:
        """Return what was registered for a type. Raises TypeException: nothing was."""
        return _registered(self._types, key)


class ConvertRegistration:
    """What converts objects between types and their messages; shared by all buffers."""

    _to_msg: ClassVar[dict[Any, Callable[[Any], Any]]] = {}
    _from_msg: ClassVar[dict[Any, Callable[[Any], Any]]] = {}
    _convert: ClassVar[dict[Any, Callable[[Any], Any]]] = {}

    def add_from_msg(self, key: Any, callback: Callable[[Any], Any]) -> None:
        """Register how a type is made from its message."""
        self._from_msg[key] = callback

    def add_to_msg(self, key: Any, callback: Callable[[Any], Any]) -> None:
        """Register how a type becomes its message."""
        self._to_msg[key] = callback

    def add_convert(self, key: tuple[Any, Any], callback: Callable[[Any], Any]) -> None:
        """Register a direct conversion from the first type to the second."""
        self._convert[key] = callback

    def get_from_msg(self, key: Any) -> Callable[[Any], Any]:
        """Return how a type is made from its message, or raise TypeException."""
        return _registered(self._from_msg, key)

    def get_to_msg(self, key: Any) -> Callable[[Any], Any]:
        """Return how a type becomes its message, or raise TypeException."""
        return _registered(self._to_msg, key)

    def get_convert(self, key: tuple[Any, Any]) -> Callable[[Any], Any]:
        """Return the direct conversion between two types, or raise TypeException."""
        return _registered(self._convert, key)


def _registered(table: dict[Any, Callable[..., Any]], key: Any) -> Callable[..., Any]:
    if key not in table:
        raise TypeException(f"Type {key!s} is not loaded or supported")
    return table[key]


def convert(a: Any, b_type: Any) -> Any:
    """Return `a` as an object of type `b_type`. Raises TypeException: no conversion is registered."""
    registration = ConvertRegistration()
    try:
        return registration.get_convert((type(a), b_type))(a)
    except TypeException:
        if type(a) is b_type:
            return deepcopy(a)
        return registration.get_from_msg(b_type)(registration.get_to_msg(type(a))(a))
