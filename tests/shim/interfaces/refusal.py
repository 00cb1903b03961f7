"""What a message says to a value it refuses."""

from typing import Any

import pytest


def refused(message: Any, field: str, value: object) -> str:
    """Assign and return the text of the AssertionError, without pytest's explanation of operands."""
    with pytest.raises(AssertionError) as caught:
        setattr(message, field, value)
    return str(caught.value)
