"""A small imitation of `launch`: a description is evaluated as upstream's, and what it would start is collected.

Nothing is started here: no process can be. The names are upstream's (launch 1.0, Humble); what is not imitated
raises an ImportError or AttributeError as any missing name.
"""

from launch import actions, conditions, event_handlers, launch_description_sources, substitutions
from launch._evaluation import Action, Condition, LaunchContext, LaunchDescription, Substitution
from launch.launch_description_sources import LaunchDescriptionSource

LaunchDescriptionEntity = Action
SomeSubstitutionsType = object

__all__ = [
    "Action",
    "Condition",
    "LaunchContext",
    "LaunchDescription",
    "LaunchDescriptionEntity",
    "LaunchDescriptionSource",
    "SomeSubstitutionsType",
    "Substitution",
    "actions",
    "conditions",
    "event_handlers",
    "launch_description_sources",
    "substitutions",
]
