"""Reading an uploaded folder: by a confined process, which answers with the assignment or with what is wrong.

YAML is much to go wrong for a file of somebody else's: an alias of an alias fills any memory. So nothing of an
upload is parsed in the service's own process (`grader.grading.examination.confined` is the other side).
"""

import os
import re
import sys
import tempfile
import threading
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Final

from grader.catalog.files import SPEC_NAME
from grader.contracts.assignment import Assignment, WrongAttempt
from grader.contracts.errors import AssignmentError, InfrastructureError
from grader.contracts.own_assignment import Misfit
from grader.contracts.record import Record, field, from_json
from grader.contracts.text import Text
from grader.grading.launch import import_path
from grader.jail import readers

_MAX_ANSWER_BYTES: Final = 32 * 1024 * 1024
_MOST_SHOWN: Final = 50
_AT_ONCE: Final = threading.BoundedSemaphore(2)
_UNNAMED: Final = "assignment"
_ID: Final = re.compile(rb"""^id:[ \t]*["']?([a-z][a-z0-9_]{0,39})["']?[ \t]*(#.*)?\r?$""", re.MULTILINE)
_PLACE: Final = re.compile(r"(?P<file>[^:]*)(?::(?P<line>\d+))?(?:: (?P<field>.*))?", re.DOTALL)
_TOO_MUCH: Final = Text(
    zh="读这个文件要的内存或时间太多：去掉重复引用的 YAML 锚点，或缩短",
    en="reading this takes too much memory or time; remove aliases that are repeated, or shorten it",
)


_PROGRAM: Final = (  # looking for garbage among what is imported takes a sixth of the process's time
    "import gc, os, sys; gc.disable(); sys.path[:] = sys.argv[1].split(os.pathsep); "
    "from grader.grading.examination.confined import main; sys.exit(main(sys.argv[2]))"
)
TOO_MUCH: Final = 3
"""Exit code of the process when it ran out of memory."""


class Reading(Record):
    """What reading a folder gave: the assignment with the scripts that must go wrong, or what is wrong with it.

    Attributes:
        changed: by name the wrong scripts that are written as changes of others.
    """

    assignment: Assignment | None = None
    wrong: tuple[WrongAttempt, ...] = ()
    changed: Mapping[str, str] = field(default_factory=dict)

    def scripts(self, files: Mapping[str, bytes]) -> dict[str, bytes]:
        """Return the folder's files and the changed scripts, by their paths in the folder."""
        return {**files, **{f"wrong/{name}": text.encode() for name, text in self.changed.items()}}

    misfits: tuple[Misfit, ...] = ()


def read_folder(files: Mapping[str, bytes]) -> Reading:
    """Return the assignment that the files of a folder describe, or what is wrong with them.

    Raises InfrastructureError: the process that reads could not be started, failed, or got no time or memory.
    """
    with tempfile.TemporaryDirectory(prefix="grader-upload-") as place, _AT_ONCE:
        folder = Path(place, declared_id(files))
        for name, content in files.items():  # names of `grader.grading.examination.zipped`
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        return _answer(folder)


def declared_id(files: Mapping[str, bytes]) -> str:
    """Return the id that the specification says, by which its folder is called; some name where it says none."""
    match = _ID.search(files.get(SPEC_NAME, b""))
    return match[1].decode() if match else _UNNAMED


def misfits_of(error: AssignmentError, root: str = "") -> tuple[Misfit, ...]:
    """Return what an error says is wrong, by file, line and field; paths as they are seen from `root`."""
    problems: Iterable[tuple[str, Text]] = error.problems or [("", error.text)]
    return tuple(
        _misfit(place, told, f"{root}/" if root else "") for place, told in [*problems][:_MOST_SHOWN]
    )


def _misfit(place: str, told: Text, root: str) -> Misfit:
    told = replace(told, zh=told.zh.replace(root, ""), en=told.en.replace(root, "")) if root else told
    match = _PLACE.fullmatch(place.removeprefix(root))
    assert match is not None
    line = None if match["line"] is None else int(match["line"])
    return Misfit(file=match["file"], line=line, field=match["field"] or "", told=told)


def _answer(folder: Path) -> Reading:
    environment = {"PATH": os.environ.get("PATH", "")}
    single_threaded = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    command = [sys.executable, "-I", "-c", _PROGRAM, import_path(), str(folder)]
    try:
        code, answer = readers.answer_of(
            command, most_bytes=_MAX_ANSWER_BYTES, environment=environment | single_threaded
        )
    except readers.TooMuchError:
        return _refused(_TOO_MUCH)
    if code == TOO_MUCH:
        return _refused(_TOO_MUCH)
    try:
        return from_json(Reading, answer)
    except ValueError as error:
        raise InfrastructureError(f"the reader of uploads answered nonsense: {error}") from error


def _refused(told: Text) -> Reading:
    return Reading(misfits=(Misfit(file=SPEC_NAME, told=told),))
