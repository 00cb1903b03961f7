"""The catalog of assignments: finds, reads and validates ``assignments/<id>/assignment.yaml``.

The folder is looked for inside the package (an installed wheel), then beside it (a source tree), unless one
is named.
"""

from collections.abc import Iterator
from fnmatch import fnmatchcase
from pathlib import Path, PurePath

from grader.catalog.document import Document
from grader.contracts.assignment import Assignment, WrongAttempt
from grader.contracts.errors import AssignmentError, UnknownAssignmentError

SPEC_NAME = "assignment.yaml"


def default_root() -> Path:
    """Return the folder of the assignments that come with the grader.

    Raises:
        AssignmentError: the installation has none.
    """
    package = Path(__file__).resolve().parents[1]
    for root in (package / "assignments", package.parent / "assignments"):
        if root.is_dir():
            return root
    raise AssignmentError("the assignments are missing from this installation; reinstall the grader")


class Catalog:
    """The assignments under one folder. Implements `grader.contracts.grading.AssignmentSource`.

    Every call reads the files anew, so an edited assignment is seen without a restart.
    """

    def __init__(self, root: Path | None = None) -> None:
        self.root = default_root() if root is None else root

    def all(self) -> tuple[Assignment, ...]:
        """Return every assignment in the order of the checklist.

        Raises:
            AssignmentError: a file is wrong; the message names file, line, field and fix.
        """
        found = [self._document(folder).assignment() for folder in self._folders()]
        return tuple(sorted(found, key=lambda assignment: (assignment.order, assignment.id)))

    def get(self, assignment_id: str) -> Assignment:
        """Return one assignment, reading only its own file.

        Raises:
            UnknownAssignmentError: there is none of that name.
            AssignmentError: its file is wrong.
        """
        return self._named(assignment_id).assignment()

    def wrong_attempts(self, assignment_id: str) -> tuple[WrongAttempt, ...]:
        """Return the wrong scripts that come with an assignment and the verdicts they must get.

        Raises:
            UnknownAssignmentError: there is none of that name.
            AssignmentError: its file is wrong, or names a script that does not exist.
        """
        document = self._named(assignment_id)
        attempts = document.wrong_attempts()
        for attempt in attempts:
            path = self.folder(assignment_id) / "wrong" / attempt.file
            if not path.is_file():
                raise AssignmentError(f"{document.path}: wrong: no file {path}; add it or remove the entry")
        return attempts

    def guess_assignment(self, file_name: str) -> str | None:
        """Return the id of the first assignment on the checklist that `file_name` tells, or None."""
        name = PurePath(file_name).name.lower()
        documents = sorted(
            (self._document(folder) for folder in self._folders()), key=lambda each: each.order
        )
        for document in documents:
            if any(fnmatchcase(name, pattern.lower()) for pattern in document.file_patterns):
                return document.path.parent.name
        return None

    def folder(self, assignment_id: str) -> Path:
        """Return the folder of an assignment: starter.py, solution.py and wrong/ stand there.

        Raises:
            UnknownAssignmentError: there is none of that name.
        """
        for folder in self._folders():
            if folder.name == assignment_id:
                return folder
        known = ", ".join(sorted(folder.name for folder in self._folders()))
        raise UnknownAssignmentError(f"no assignment {assignment_id!r}; there are: {known}")

    def _folders(self) -> Iterator[Path]:
        if not self.root.is_dir():
            raise AssignmentError(f"{self.root} is not a folder of assignments")
        return (path.parent for path in sorted(self.root.glob(f"*/{SPEC_NAME}")))

    def _named(self, assignment_id: str) -> Document:
        return self._document(self.folder(assignment_id))

    def _document(self, folder: Path) -> Document:
        return Document.read(folder / SPEC_NAME)
