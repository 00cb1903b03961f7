"""How many examples the tests of properties draw."""

from typing import Any

from hypothesis import HealthCheck, settings

# The same examples every time, and no deadline: a loaded machine must not fail a test.
_ALWAYS: dict[str, Any] = {
    "deadline": None,
    "derandomize": True,
    "suppress_health_check": [HealthCheck.too_slow],
}
_SHARE = 4
"""One in so many is drawn, unless ``--hypothesis-profile=all`` asks for all: `make test-all` does."""
settings.register_profile("all", **_ALWAYS)
settings.register_profile("some", max_examples=100 // _SHARE, **_ALWAYS)
settings.load_profile("some")


def examples(number: int) -> int:
    """Return how many to draw of `number`, which stands for hypothesis's 100 where these are too many."""
    return number if settings.get_current_profile_name() == "all" else -(-number // _SHARE)
