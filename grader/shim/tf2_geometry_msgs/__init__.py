"""Moving geometry_msgs between frames, with the public names of tf2_geometry_msgs (ROS 2 Humble)."""

from tf2_geometry_msgs.tf2_geometry_msgs import *  # noqa: F403 - as upstream
