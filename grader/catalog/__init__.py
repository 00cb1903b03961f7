"""The catalog of assignments: finds, reads and validates ``assignments/<id>/assignment.yaml``.

The folder is looked for inside the package (an installed wheel), then beside it (a source tree), unless one
is named.
"""

from collections.abc import Iterable, Iterator
from fnmatch import fnmatchcase
from pathlib import Path, PurePath
from typing import TYPE_CHECKING

from grader.catalog.cache import AssignmentCache, AssignmentMemory
from grader.catalog.files import SPEC_NAME, content, handed_in, is_there
from grader.contracts.assignment import SUFFIXES, Assignment, WrongAttempt
from grader.contracts.errors import AssignmentError, UnknownAssignmentError
from grader.contracts.text import Text

if TYPE_CHECKING:  # imports pydantic and yaml, which a remembered assignment does without
    from grader.catalog.document import Document

_MISSING = Text(zh="缺少这个文件：请补上", en="this file is missing; add it")


def default_root() -> Path:
    """Return the folder of the assignments that come with the grader.

    Raises AssignmentError: the installation has none.
    """
    package = Path(__file__).resolve().parents[1]
    for root in (package / "assignments", package.parent / "assignments"):
        if root.is_dir():
            return root
    raise AssignmentError(
        "the assignments are missing from this installation; reinstall the grader",
        "安装里缺少作业：请重新安装 grader",
    )


SETS = ("robot", "pybullet", "nodes")


def set_root(name: str) -> Path | None:
    """Return the folder of a further set of assignments that comes with the grader; None where there is none."""
    folder = default_root() / name
    return folder if name in SETS and folder.is_dir() else None


class Catalog:
    """The assignments under one folder.

    A folder within it that holds assignments instead of being one is a further set: its assignments are found by
    their ids and by names of files, but `all` leaves them out.

    Every call reads the files anew, so an edited assignment is seen without a restart.
    """

    def __init__(
        self, root: Path | None = None, cache: AssignmentCache | AssignmentMemory | None = None
    ) -> None:
        """Look under `root` (None: the built-in assignments). What `cache` knows is not validated again."""
        self.root = default_root() if root is None else root
        self._cache = cache
        self._shift = 0

    def with_seeds(self, shift: int) -> "Catalog":
        """Return the same catalog with all seeds larger by `shift`: other starts, rooms and noise."""
        shifted = Catalog(self.root)
        shifted._shift = shift
        return shifted

    def all(self) -> tuple[Assignment, ...]:
        """Return every assignment in the order of the checklist.

        Raises AssignmentError: a file is wrong; the message names file, line, field and fix.
        """
        assignments = [self._assignment(folder) for folder in self._folders()]
        return tuple(sorted(assignments, key=lambda assignment: (assignment.order, assignment.id)))

    def each(self) -> Iterator[tuple[str, Assignment | AssignmentError]]:
        """Yield id and content of every assignment; of a wrong one, what is wrong.

        Raises AssignmentError: there is no such folder.
        """
        for folder in self._folders():
            try:
                yield folder.name, self._assignment(folder)
            except AssignmentError as error:
                yield folder.name, error

    def get(self, assignment_id: str) -> Assignment:
        """Return one assignment, reading only its own file.

        Raises:
            UnknownAssignmentError: no assignment has that id.
            AssignmentError: its file is wrong.
        """
        return self._assignment(self.folder(assignment_id))

    def place(self, assignment_id: str, field: str) -> str:
        """Return where a field of an assignment (``items.2.measure``) stands: file, line and field.

        Raises:
            UnknownAssignmentError: no assignment has that id.
            AssignmentError: its file cannot be read.
        """
        return self._named(assignment_id).place(field)

    def wrong_attempts(self, assignment_id: str) -> tuple[WrongAttempt, ...]:
        """Return the wrong scripts that come with an assignment and the scores they must get.

        Raises:
            UnknownAssignmentError: no assignment has that id.
            AssignmentError: its file is wrong, or names a script that does not exist.
        """
        self.changed_scripts(assignment_id)
        return self._named(assignment_id).wrong_attempts()

    def changed_scripts(self, assignment_id: str) -> dict[str, bytes]:
        """Return by name the wrong scripts of an assignment that are written as changes of others.

        Raises:
            UnknownAssignmentError: no assignment has that id.
            AssignmentError: its file is wrong, names a script that does not exist, or a change does not fit.
        """
        document = self._named(assignment_id)
        changed = document.changed_scripts()
        for i, attempt in enumerate(document.wrong_attempts()):
            path = self.folder(assignment_id) / "wrong" / attempt.file
            if is_there(path) and attempt.file in changed:
                raise _refused(document.place(f"wrong.{i}.change"), _both(path))
            if not is_there(path) and attempt.file not in changed:
                raise _refused(document.place(f"wrong.{i}.file"), _not_there(path))
        return changed

    def scripts(self, assignment_id: str) -> dict[str, bytes]:
        """Return all scripts that come with an assignment: ``solution.py``, ``starter.py``, ``wrong/<file>``.

        Raises:
            UnknownAssignmentError: no assignment has that id.
            AssignmentError: its file is wrong, or one of the scripts is missing.
            OSError: one cannot be read.
        """
        changed = self.changed_scripts(assignment_id)
        folder = self.folder(assignment_id)
        own = [self.own_file(self.get(assignment_id), name) for name in ("solution", "starter")]
        wrong = [folder / "wrong" / attempt.file for attempt in self._named(assignment_id).wrong_attempts()]
        return {
            str(path.relative_to(folder)): changed[path.name] if path.name in changed else handed_in(path)
            for path in (*own, *wrong)
        }

    def guess_assignment(self, file_name: str) -> str | None:
        """Return the id of the assignment whose file patterns match `file_name`, or None.

        If several match, the longest pattern wins (``*square_input*.py`` before ``*square*.py``), then the order
        of the checklist. Further sets are searched if none matches.
        """
        return self._guess(file_name, self._folders()) or self._guess(file_name, self._further())

    def _guess(self, file_name: str, folders: Iterable[Path]) -> str | None:
        name = PurePath(file_name).name.lower()
        matches = [
            (-len(pattern), order, folder.name)
            for folder in folders
            for order, patterns in (self._order_and_patterns(folder),)
            for pattern in patterns
            if fnmatchcase(name, pattern.lower())
        ]
        return min(matches)[2] if matches else None

    def own_file(self, assignment: Assignment, name: str) -> Path:
        """Return the path of an assignment's own file: ``solution.py``, ``solution.txt`` for a text, ``.zip``.

        A folder ``solution`` may stand for ``solution.zip``; `grader.catalog.files.handed_in` reads both.

        Raises AssignmentError: it is not there.
        """
        path = self.folder(assignment.id) / (name + SUFFIXES[assignment.input][0])
        if not is_there(path):
            raise _refused(str(path), _MISSING)
        return path

    def lesson(self) -> Path | None:
        """Return the folder of the listings that the course's text prints; None where there is none."""
        folder = self.root.parent / "lesson"
        return folder if folder.is_dir() else None

    def starter(self, assignment_id: str) -> bytes:
        """Return the script that students of an assignment begin with; empty where it has none."""
        path = self.folder(assignment_id) / "starter.py"
        return path.read_bytes() if path.is_file() else b""

    def files(self, assignment_id: str) -> dict[str, bytes]:
        """Return all files of an assignment's folder by their paths in it.

        Raises UnknownAssignmentError: no assignment has that id.
        """
        folder = self.folder(assignment_id)
        paths = (path for path in sorted(folder.rglob("*")) if path.is_file())
        return {
            str(path.relative_to(folder)): path.read_bytes()
            for path in paths
            if "__pycache__" not in path.parts
        }

    def given_code(self) -> tuple[bytes, ...]:
        """Return the scripts that every student can read: starters, solutions and the lesson's listings."""
        folders, lesson = [*self._folders(), *self._further()], self.lesson()
        paths = [folder / name for folder in folders for name in ("starter.py", "solution.py")]
        paths += [folder / name for folder in folders for name in ("starter.zip", "solution.zip")]
        paths += [] if lesson is None else sorted(lesson.glob("*.py"))
        return tuple(handed_in(path) for path in paths if is_there(path))

    def folder(self, assignment_id: str) -> Path:
        """Return the folder of an assignment: starter, solution and wrong/ stand there.

        Raises UnknownAssignmentError: no assignment has that id.
        """
        for folder in (*self._folders(), *self._further()):
            if folder.name == assignment_id:
                return folder
        raise UnknownAssignmentError.among((folder.name for folder in self._folders()), assignment_id)

    def _folders(self) -> Iterator[Path]:
        if not self.root.is_dir() or is_there(self.root / SPEC_NAME):
            raise AssignmentError(
                f"{self.root} is not a folder of assignments, each in a folder of its own",
                f"{self.root} 不是作业文件夹：里面应当每个作业一个文件夹",
            )
        return (path.parent for path in sorted(self.root.glob(f"*/{SPEC_NAME}")))

    def _further(self) -> Iterator[Path]:
        """Yield the folders of the further sets' assignments."""
        for path in sorted(self.root.glob(f"*/*/{SPEC_NAME}")):
            if not (path.parents[1] / SPEC_NAME).exists():
                yield path.parent

    def _named(self, assignment_id: str) -> "Document":
        return self._document(self.folder(assignment_id))

    def _order_and_patterns(self, folder: Path) -> tuple[float, tuple[str, ...]]:
        """Return what `guess_assignment` needs, also of a file that is not valid."""
        try:
            assignment = self._assignment(folder) if self._cache is not None else None
        except AssignmentError:
            assignment = None
        if assignment is not None:
            return assignment.order, assignment.file_patterns
        document = self._document(folder)
        return document.order, document.file_patterns

    def _assignment(self, folder: Path) -> Assignment:
        path = folder / SPEC_NAME
        remembered = None if self._cache is None else self._cache.find(path)
        if remembered is not None:
            return remembered
        source = _content(path)
        assignment = self._document(folder).assignment()
        if self._cache is not None and source is not None and source == _content(path):
            self._cache.keep(path, source, assignment)
        return assignment

    def _document(self, folder: Path) -> "Document":
        from grader.catalog.document import Document

        return Document.read(folder / SPEC_NAME).with_seeds(self._shift)


def _not_there(path: Path) -> Text:
    return Text(
        zh=f"没有文件 {path}：补上，写成 change，或者删掉这一项",
        en=f"no file {path}; add it, write a change or remove the entry",
    )


def _both(path: Path) -> Text:
    return Text(
        zh=f"已经有文件 {path}：删掉文件，或者删掉 change",
        en=f"there is a file {path}, too; remove it or the change",
    )


def _refused(place: str, told: Text) -> AssignmentError:
    from grader.catalog.misfits import refusals

    return refusals([(place, told)])


def _content(path: Path) -> bytes | None:
    """Return the content of an assignment's files, or None if they cannot be read; the next reader reports why."""
    try:
        return content(path)
    except OSError:
        return None
