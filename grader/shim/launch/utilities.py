"""What launch's own actions are made with, and with it those that launch files define themselves."""

from __future__ import annotations

from collections.abc import Iterable

from launch._evaluation import LaunchContext, Substitution, checked, perform
from launch.substitutions import TextSubstitution

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

__all__ = [
    "ensure_argument_type",
    "is_a",
    "is_a_subclass",
    "isclassinstance",
    "normalize_to_list_of_substitutions",
    "perform_substitutions",
]


def perform_substitutions(context: LaunchContext, subs: Iterable[Any]) -> str:
    """Return the joined texts of substitutions."""
    return "".join([perform(context, sub) for sub in subs])


def normalize_to_list_of_substitutions(subs: Any) -> list[Substitution]:
    """Return a list of substitutions for a text, a substitution, or several.

    Raises TypeError: it is something else.
    """
    checked(subs)
    sequence = [subs] if isinstance(subs, (str, Substitution)) else subs
    return [TextSubstitution(text=element) if isinstance(element, str) else element for element in sequence]


def ensure_argument_type(argument: Any, types: Any, argument_name: str, caller: str | None = None) -> None:
    """Check the type of an argument. Raises TypeError: it is of none of these types."""
    classes = tuple(types) if isinstance(types, Iterable) else (types,)
    if not isinstance(argument, classes):
        start = "E" if caller is None else f"'{caller}' e"
        kinds = ", ".join(str(type_) for type_ in classes)
        raise TypeError(
            f"{start}xpected '{argument_name}' to be one of [{kinds}], "
            f"but got '{argument}' of type '{type(argument)}'"
        )


def is_a(obj: Any, entity_type: type) -> bool:
    """Return whether an object is of a type."""
    return isinstance(obj, entity_type)


def is_a_subclass(obj: Any, entity_type: type) -> bool:
    """Return whether an object, or a class, is of a type."""
    return isinstance(obj, entity_type) or (isinstance(obj, type) and issubclass(obj, entity_type))


def isclassinstance(obj: Any) -> bool:
    """Return whether an object is of a class and none itself."""
    return hasattr(obj, "__class__") and not isinstance(obj, type)
