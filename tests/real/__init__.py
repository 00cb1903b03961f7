"""Recordings of the real ROS 2 Humble and turtlesim 1.4, and what ours does with the same scripts."""
