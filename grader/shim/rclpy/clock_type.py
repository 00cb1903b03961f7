"""Kinds of clocks."""

from rclpy._rcl.enums import ClockType

__all__ = ["ClockType"]
