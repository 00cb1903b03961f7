"""Which state of a thing somebody looked at before changing it, so that nobody undoes what they never saw."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Seen:
    """States of one thing, by their tags. `tags` is None when any state will do."""

    tags: frozenset[str] | None

    @classmethod
    def one(cls, tag: str) -> "Seen":
        """Return the state named `tag` alone."""
        return cls(frozenset({tag}))

    def includes(self, tag: str) -> bool:
        """Return whether the state named `tag` is one of them."""
        return self.tags is None or tag in self.tags
