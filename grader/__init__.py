"""Deterministic auto-grader for introductory ROS 2 motion exercises."""

__version__ = "0.1.0"
