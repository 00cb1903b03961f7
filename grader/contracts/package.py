"""What is said about a handed-in package."""

from collections.abc import Mapping
from typing import Final

from grader.contracts.record import Record, field
from grader.contracts.text import Text

MANIFEST, NAMES, MODULES, ENTRY, SHARE = (
    "package_manifest",
    "package_names",
    "package_modules",
    "package_entry",
    "package_share",
)
AREAS: Final = (MANIFEST, NAMES, MODULES, ENTRY, SHARE)
"""The measures that problems of a package spoil."""


class PackageProblem(Record, kw_only=False):
    """A mistake in a package's files.

    Attributes:
        code: of the mistake; its text is ``mistake.<code>``.
        area: the measure that it spoils, one of `AREAS`.
        fatal: whether nothing of the package can be run because of it.
        values: what its text names.
    """

    code: str
    area: str
    fatal: bool
    values: Mapping[str, str | Text] = field(default_factory=dict)
