"""What parts of the shim need of each other; imported by type checkers only."""

from __future__ import annotations

from typing import Protocol


class World(Protocol):
    """What the kernel needs of the link to the episode."""

    coupled: bool

    def advance(self, target_ns: int) -> int:
        """Let the world run to `target_ns`, deliver what is due, return the instant reached."""


class Sentinel(Protocol):
    """A lock that somebody who joins a thread waits for."""

    def locked(self) -> bool:
        """Return whether it is held."""

    def release(self) -> None:
        """Release it."""


class Channel(Protocol):
    """The two operations on a connected stream socket that the link uses."""

    def sendall(self, data: bytes, /) -> None:
        """Send all of `data`."""

    def recv(self, size: int, /) -> bytes:
        """Receive up to `size` bytes; empty at the end of the stream."""
