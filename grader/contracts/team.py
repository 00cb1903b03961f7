"""Students who hand in together for one assignment: what one of them uploads is a submission of each."""

from dataclasses import dataclass

LARGEST_TEAM = 10


@dataclass(frozen=True, slots=True, kw_only=True)
class Team:
    """Who hands in together for an assignment.

    Attributes:
        code: by which others join a team that students formed.
        members: in order.
        by_staff: it was formed by staff: nobody joins or leaves it.
    """

    code: str
    members: tuple[str, ...]
    by_staff: bool
