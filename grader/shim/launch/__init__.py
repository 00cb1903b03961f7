"""A small imitation of `launch`: a description is evaluated as upstream's, and what it would start is collected.

Nothing is started here: no process can be. The names are those of launch 1.0 (Humble) and, where Jazzy is chosen,
of launch 3.4. What is not imitated raises an ImportError or AttributeError as any missing name.
"""

from __future__ import annotations

from collections.abc import Iterable

from rclpy import _distro

from launch import (
    actions,
    conditions,
    descriptions,
    event_handlers,
    events,
    launch_description_sources,
    logging,
    substitutions,
    utilities,
)
from launch._evaluation import (
    Action,
    Condition,
    Event,
    LaunchContext,
    LaunchDescription,
    LaunchDescriptionEntity,
    Substitution,
)
from launch._handlers import BaseEventHandler as BaseEventHandler
from launch._handlers import EventHandler
from launch._modules import offer
from launch._service import LaunchIntrospector, LaunchService
from launch.launch_description_sources import InvalidLaunchFileError, LaunchDescriptionSource

SomeSubstitutionsType = str | Substitution | Iterable[str | Substitution]
SomeSubstitutionsType_types_tuple = (str, Substitution, Iterable)

__all__ = [
    "Action",
    "Condition",
    "Event",
    "EventHandler",
    "InvalidLaunchFileError",
    "LaunchContext",
    "LaunchDescription",
    "LaunchDescriptionEntity",
    "LaunchDescriptionSource",
    "LaunchIntrospector",
    "LaunchService",
    "SomeSubstitutionsType",
    "SomeSubstitutionsType_types_tuple",
    "Substitution",
    "actions",
    "conditions",
    "descriptions",
    "event_handlers",
    "events",
    "launch_description_sources",
    "logging",
    "substitutions",
    "utilities",
]
if _distro.chosen == _distro.HUMBLE:
    SomeActionsType = LaunchDescriptionEntity | Iterable[LaunchDescriptionEntity]
    SomeActionsType_types_tuple = (LaunchDescriptionEntity, Iterable)
    __all__ += ["SomeActionsType", "SomeActionsType_types_tuple"]
else:
    SomeEntitiesType = LaunchDescriptionEntity | Iterable[LaunchDescriptionEntity]
    SomeEntitiesType_types_tuple = (LaunchDescriptionEntity, Iterable)
    __all__ += ["SomeEntitiesType", "SomeEntitiesType_types_tuple"]

offer(__name__, *(name for name in __all__ if name[0].isupper()), "BaseEventHandler")
for _package in (actions, conditions, event_handlers, events, launch_description_sources, substitutions):
    offer(_package.__name__, Shutdown="shutdown_action" if _package is actions else "shutdown")
offer("launch.events.process")
offer("launch.descriptions")
offer(
    "launch.utilities",
    perform_substitutions="perform_substitutions_impl",
    normalize_to_list_of_substitutions="normalize_to_list_of_substitutions_impl",
    ensure_argument_type="ensure_argument_type_impl",
)
