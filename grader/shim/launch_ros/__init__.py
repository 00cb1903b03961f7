"""A small imitation of `launch_ros`: nodes as launch's actions; see `launch`."""

from launch_ros import actions, parameter_descriptions, substitutions

__all__ = ["actions", "parameter_descriptions", "substitutions"]
