"""The processes behind a sandbox and a run, for tests that look at them or kill them.

Where a sandbox keeps them is its own business: among the tests only this module knows it.
"""

from typing import Any


def zygote_of(sandbox: Any) -> Any:
    """Return the process that the sandbox forks scripts' processes from."""
    return sandbox._zygote._process


def spare_of(sandbox: Any) -> Any:
    """Return the confined process that waits for the next run, or None."""
    return sandbox._spare


def process_of(owner: Any) -> Any:
    """Return the process of a run, or the one that grades for a slot, or None."""
    return owner._process
