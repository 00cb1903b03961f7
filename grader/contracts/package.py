"""What is said about a handed-in package."""

from collections.abc import Mapping

from grader.contracts.record import PositionalRecord, field


class PackageProblem(PositionalRecord):
    """A mistake in a package's files.

    Attributes:
        code: of the mistake; its text is ``mistake.<code>``.
        area: the measure that it spoils, such as ``package_entry``.
        fatal: whether nothing of the package can be run because of it.
        values: what its text names.
    """

    code: str
    area: str
    fatal: bool
    values: Mapping[str, str] = field(default_factory=dict)
