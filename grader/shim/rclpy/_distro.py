"""Humble or Jazzy: which of the two a script finds.

The modules of `rclpy` are Humble's. What Jazzy adds or does otherwise stands beside them and nowhere else: the
modules of `rclpy._jazzy` change those of `rclpy` once, before the script is compiled. Modules that only Jazzy has
stand in their places, and on Humble cannot be imported.
"""

from __future__ import annotations

import sys

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

HUMBLE = "humble"
JAZZY = "jazzy"

ONLY_ON_JAZZY = frozenset(
    f"rclpy.{name}"
    for name in (
        "clock_type",
        "destroyable",
        "event_handler",
        "logging_service",
        "parameter_client",
        "parameter_event_handler",
        "service_introspection",
        "type_description_service",
        "type_hash",
    )
)


class _NotOnHumble:
    """Finder that finds nothing, and nobody else may look for what Humble does not have."""

    @staticmethod
    def find_spec(name: str, path: Any = None, target: Any = None) -> None:
        if name in ONLY_ON_JAZZY:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)


chosen = HUMBLE


def choose(distro: str) -> None:
    """Make `distro` the release that the script finds. Called once, before the script is compiled.

    Raises ValueError: there is no such distro here.
    """
    global chosen
    chosen = distro
    if distro == HUMBLE:
        finder: Any = _NotOnHumble
        sys.meta_path.insert(0, finder)
    elif distro == JAZZY:
        from rclpy import _jazzy

        _jazzy.install()
    else:
        raise ValueError(f"no distro {distro!r}")
