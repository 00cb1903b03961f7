"""What Python 3.11 has and 3.10 has not; it goes when Ubuntu 22.04, whose Python is 3.10, is out of use."""

import sys
from datetime import timezone
from typing import Final

if sys.version_info >= (3, 11):
    from enum import StrEnum
    from typing import Self, dataclass_transform
else:
    from enum import Enum

    from typing_extensions import Self, dataclass_transform

    class StrEnum(str, Enum):
        """An enumeration of texts; each member is its text, also where it is formatted."""

        __str__ = str.__str__
        __format__ = str.__format__

        @staticmethod
        def _generate_next_value_(name: str, start: int, count: int, last_values: list[str]) -> str:
            return name.lower()


UTC = timezone.utc

SAFE_PATH: Final = ("-P",) if sys.version_info >= (3, 11) else ()
"""Options that keep the current folder, where a student's ``random.py`` may lie, out of an import path.

Python 3.10 has none; there the program drops that entry, which is empty, itself.
"""

__all__ = ["SAFE_PATH", "UTC", "Self", "StrEnum", "dataclass_transform"]
