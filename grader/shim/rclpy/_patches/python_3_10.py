"""What Python 3.10, which is Humble's, does otherwise than newer ones, where a script's course depends on it.

Jazzy's Python 3.12 does as the newer ones.
"""

from __future__ import annotations

from rclpy import _distro

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable
    from types import ModuleType
    from typing import Any


def restore(module: ModuleType) -> None:
    """Let a module of the standard library do as on 3.10, if the script is to find Humble."""
    if _distro.chosen == _distro.HUMBLE:
        _CHANGES[module.__name__](module)


def _change_enum(enum: Any) -> None:
    """Let ``str`` name the member of an IntEnum, and ``f"{Topic.POSE}"`` be the text where `Topic` is a str.

    Python 3.11 has exchanged the two.
    """
    by_name = (enum.Enum.__str__, enum.Flag.__str__)
    enum.IntEnum.__str__, enum.IntFlag.__str__ = by_name

    def as_value(self: Any, spec: str) -> str:
        named = self._member_type_ is object or type(self).__str__ not in by_name
        return format(str(self) if named else self._value_, spec)

    def renew(cls: Any) -> None:
        if cls is enum.Enum or vars(cls).get("__format__") is cls._member_type_.__format__:
            cls.__format__ = as_value
        for derived in cls.__subclasses__():
            renew(derived)

    renew(enum.Enum)


def _change_dataclasses(dataclasses: Any) -> None:
    """Allow any default but lists, dicts and sets: a message, an array, another data class."""
    get_field = dataclasses._get_field

    def get_any_field(cls: Any, name: str, *rest: Any) -> Any:
        default = getattr(cls, name, dataclasses.MISSING)
        owner, place = (default, "default") if isinstance(default, dataclasses.Field) else (cls, name)
        value = getattr(owner, place, dataclasses.MISSING)
        if type(value).__hash__ is not None or isinstance(value, (list, dict, set)):
            return get_field(cls, name, *rest)
        setattr(owner, place, object())
        field = get_field(cls, name, *rest)
        field.default = value
        setattr(owner, place, value)
        return field

    dataclasses._get_field = get_any_field


def _change_asyncio(asyncio: Any) -> None:
    """Let `asyncio.wait` take coroutines, with a warning, and `asyncio.run` set no handler of SIGINT."""
    wait = asyncio.wait

    async def wait_for_any(fs: Iterable[Any], **options: Any) -> Any:
        if not (asyncio.isfuture(fs) or asyncio.iscoroutine(fs)) and any(
            map(asyncio.iscoroutine, fs := set(fs))
        ):
            from warnings import warn

            text = (
                "The explicit passing of coroutine objects to asyncio.wait() is deprecated since Python 3.8, and "
                "scheduled for removal in Python 3.11."
            )
            warn(text, DeprecationWarning, stacklevel=2)
            fs = {asyncio.ensure_future(awaitable) for awaitable in fs}
        return await wait(fs, **options)

    wait_for_any.__name__ = wait_for_any.__qualname__ = "wait"
    asyncio.wait = asyncio.tasks.wait = wait_for_any
    asyncio.runners.signal = _NoHandler(asyncio.runners.signal)


class _NoHandler:
    """What `asyncio.run` takes for `signal`: it leaves Ctrl+C to rclpy, whose handler ends the contexts."""

    def __init__(self, signal: Any) -> None:
        self.SIGINT = signal.SIGINT
        self.default_int_handler = signal.default_int_handler

    def getsignal(self, _number: int) -> None:
        """Tell of a handler that no Python code has set."""


_CHANGES = {"asyncio": _change_asyncio, "dataclasses": _change_dataclasses, "enum": _change_enum}
