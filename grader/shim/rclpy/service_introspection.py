"""How much of a service's traffic is published."""

from rclpy._rcl.enums import NativeEnum


class ServiceIntrospectionState(NativeEnum):
    """What clients and services publish of each request and response."""

    OFF = 0
    METADATA = 1
    CONTENTS = 2
