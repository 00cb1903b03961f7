"""The table of ROS's interfaces, which `tools/generate_interfaces.py` writes and describes."""

from collections.abc import Iterator
from pathlib import Path
from typing import Final

STANDARD: Final = Path(__file__).resolve().parents[1] / "shim" / "rosidl_data" / "humble.txt"


def standard_entries() -> list[str]:
    """Return the entries of ROS's own interfaces, each in the form of `InterfaceDefinition.lines`."""
    return STANDARD.read_text("utf-8").split("\n@")[1:]


def structures_of(entry: str) -> Iterator[tuple[str, list[list[str]]]]:
    """Yield the structures of an interface: full name; of each field name, IDL type and, where given, default."""
    head, *parts = entry.split("\n=")
    namespace = head.partition(" ")[0].rpartition("/")[0]
    for part in parts:
        name, *members = part.rstrip("\n").split("\n")
        yield f"{namespace}/{name}", [member.split(" ", 2) for member in members if member[0] != "!"]
