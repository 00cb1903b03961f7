"""Events about nodes."""

from __future__ import annotations

from launch._modules import offer

from launch_ros.events import lifecycle
from launch_ros.events.lifecycle import matches_node_name

__all__ = ["lifecycle", "matches_node_name"]

offer(__name__, matches_node_name="matchers")
