"""Start a new assignment: a complete, working example to edit."""

import re
from pathlib import Path
from string import Template

from grader.catalog import Catalog
from grader.catalog.files import SPEC_NAME
from grader.contracts.assignment import Assignment
from grader.contracts.errors import AssignmentError
from grader.contracts.text import trouble

_SKELETON = Path(__file__).with_name("skeleton")
_TEMPLATE_SUFFIX = ".txt"  # of scripts, so that tools do not take them for the grader's own source
_NAME = re.compile(r"[a-z][a-z0-9_]{0,39}")


def create(catalog: Catalog, name: str, like: Path | None = None) -> Path:
    """Make the folder of a new assignment of the id `name`, at the end of the checklist; return it.

    It begins as a copy of the folder `like`; None: as a simple example.

    Raises AssignmentError: the name is not a valid id or is taken, or the folder cannot be written.
    """
    if not _NAME.fullmatch(name):
        raise AssignmentError(
            f"{name!r}: use small letters, digits and _, beginning with a letter",
            f"{name!r}：用小写英文字母、数字和 _，以字母开头",
        )
    folder = catalog.root / name
    if folder.exists():
        raise AssignmentError(
            f"{folder} exists already; choose another name or edit it",
            f"已经有 {folder}：换一个名字，或者直接改它",
        )
    existing = [each for _, each in catalog.each()]  # a wrong one beside it keeps nobody from beginning
    order = (
        max((assignment.order for assignment in existing if isinstance(assignment, Assignment)), default=0)
        + 1
    )
    try:
        _copy(_SKELETON if like is None else like, folder, name, order)
    except OSError as error:
        raise AssignmentError.about(folder, trouble(error)) from error
    return folder


def _copy(root: Path, folder: Path, name: str, order: int) -> None:
    """Copy an assignment's files, and give the copy its own id and place.

    Raises OSError: a file cannot be read or written.
    """
    suffix = _TEMPLATE_SUFFIX if root == _SKELETON else ""
    for source in sorted(path for path in root.rglob("*") if path.is_file()):
        target = folder / str(source.relative_to(root)).removesuffix(suffix)
        target.parent.mkdir(parents=True, exist_ok=True)
        text = source.read_text(encoding="utf-8")
        if target == folder / SPEC_NAME:
            is_template = root == _SKELETON
            text = (
                Template(text).substitute(id=name, order=order)
                if is_template
                else _renamed(text, name, order)
            )
        target.write_text(text, encoding="utf-8")


def _renamed(spec: str, name: str, order: int) -> str:
    """Return an ``assignment.yaml`` with the id, order and file names of a new assignment."""
    lines = {"id": name, "version": "1", "order": str(order), "file_patterns": f'["*{name}*"]'}
    for field, value in lines.items():
        spec = re.sub(rf"^{field}:.*$", f"{field}: {value}", spec, count=1, flags=re.MULTILINE)
    return spec
