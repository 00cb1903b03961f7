"""A small imitation of `launch_ros`: nodes as launch's actions; see `launch`."""

from launch_ros import actions, descriptions, event_handlers, events, parameter_descriptions, substitutions

__all__ = ["actions", "descriptions", "event_handlers", "events", "parameter_descriptions", "substitutions"]
