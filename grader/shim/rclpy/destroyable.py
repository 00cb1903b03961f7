"""What handles have in common, for annotations."""

from typing import Any, Protocol


class DestroyableType(Protocol):
    """Something destroyed on request, but not while it is in use."""

    def __enter__(self) -> None: ...
    def __exit__(self, exc_type: Any, exc_val: Any, exctb: Any) -> None: ...
    def destroy_when_not_in_use(self) -> None:
        """Forbid further use."""
