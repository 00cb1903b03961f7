"""Remembered assignments: the same as validated ones, and never older than their file."""

import subprocess
import sys
from pathlib import Path

import pytest

from grader import catalog
from grader.catalog import Catalog, cache, default_root
from grader.catalog.cache import AssignmentCache, AssignmentMemory, default_cache_folder
from grader.contracts.assignment import Assignment
from grader.contracts.errors import AssignmentError

SQUARE = default_root() / "square" / "assignment.yaml"
NAMES = [assignment.id for assignment in Catalog().all()]


@pytest.fixture
def remembering(tmp_path: Path) -> AssignmentCache:
    return AssignmentCache(tmp_path / "cache")


@pytest.fixture
def only_remembered(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make it an error to read a document."""

    def refuse(*_: object) -> None:
        raise AssertionError("a document was read")

    monkeypatch.setattr(Catalog, "_document", refuse)


@pytest.fixture
def own(tmp_path: Path) -> Path:
    """A catalog with a copy of one assignment."""
    folder = tmp_path / "own" / "square"
    folder.mkdir(parents=True)
    (folder / "assignment.yaml").write_bytes(SQUARE.read_bytes())
    return folder.parent


@pytest.mark.parametrize("name", NAMES)
def test_a_remembered_assignment_is_the_validated_one(name: str, remembering: AssignmentCache) -> None:
    read = Catalog(cache=remembering).get(name)
    remembered = remembering.find(default_root() / name / "assignment.yaml")
    assert remembered == read == Catalog().get(name)


def test_what_is_remembered_is_not_read_again(
    remembering: AssignmentCache, request: pytest.FixtureRequest
) -> None:
    first = Catalog(cache=remembering).all()
    request.getfixturevalue("only_remembered")
    second = Catalog(cache=remembering)
    assert second.all() == first
    assert second.guess_assignment("my_square_mover.py") == "square"


def test_an_edited_file_is_seen(own: Path, remembering: AssignmentCache) -> None:
    before = Catalog(own, remembering).get("square")
    file = own / "square" / "assignment.yaml"
    file.write_text(
        file.read_text(encoding="utf-8").replace("horizon_s: 60", "horizon_s: 59"), encoding="utf-8"
    )
    after = Catalog(own, remembering).get("square")
    assert (before.horizon_s, after.horizon_s) == (60.0, 59.0)


def test_a_file_that_became_wrong_is_refused(own: Path, remembering: AssignmentCache) -> None:
    Catalog(own, remembering).get("square")
    file = own / "square" / "assignment.yaml"
    file.write_text(file.read_text(encoding="utf-8") + "\nnonsense: 1\n", encoding="utf-8")
    for _ in range(2):
        with pytest.raises(AssignmentError, match="nonsense"):
            Catalog(own, remembering).get("square")


def test_the_same_bytes_in_another_folder_are_judged_anew(own: Path, remembering: AssignmentCache) -> None:
    Catalog(own, remembering).get("square")
    (own / "square").rename(own / "circle")
    with pytest.raises(AssignmentError, match="folder's name"):
        Catalog(own, remembering).get("circle")


def test_a_wrong_file_does_not_hinder_guessing(own: Path, remembering: AssignmentCache) -> None:
    file = own / "square" / "assignment.yaml"
    file.write_text(file.read_text(encoding="utf-8") + "\nnonsense: 1\n", encoding="utf-8")
    assert Catalog(own, remembering).guess_assignment("square.py") == "square"


@pytest.mark.parametrize("damage", [b"", b"{", b"[]", b'"text"', b"{}", b'{"key": 1}', b"\xff\xfe"], ids=repr)
def test_a_damaged_entry_is_replaced(damage: bytes, remembering: AssignmentCache, tmp_path: Path) -> None:
    good = Catalog(cache=remembering).get("square")
    (entry,) = (tmp_path / "cache").iterdir()
    whole = entry.read_bytes()
    entry.write_bytes(damage)
    assert Catalog(cache=remembering).get("square") == good
    assert entry.read_bytes() == whole


def test_a_damaged_assignment_in_an_entry_is_not_believed(
    remembering: AssignmentCache, tmp_path: Path
) -> None:
    good = Catalog(cache=remembering).get("square")
    (entry,) = (tmp_path / "cache").iterdir()
    entry.write_text(entry.read_text().replace('"horizon_s": 60.0', '"horizon_s": "long"'))
    assert Catalog(cache=remembering).get("square") == good


def test_other_code_validates_anew(
    remembering: AssignmentCache, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    Catalog(cache=remembering).get("square")
    monkeypatch.setattr(cache, "__version__", "another")
    assert AssignmentCache(tmp_path / "cache").find(SQUARE) is None


def test_every_module_that_validates_is_in_the_key() -> None:
    program = (
        "import sys, grader.catalog.document\n"
        "print(*(m.__file__ for n, m in sys.modules.items() if n.startswith('grader.')), sep='\\n')"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    loaded = {Path(one) for one in done.stdout.split() if not one.endswith("geometry/__init__.py")}
    assert loaded - set(cache._VALIDATORS) == set()


def test_a_folder_that_cannot_be_written_is_no_matter(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    blocked = AssignmentCache(tmp_path / "file" / "cache")
    assert isinstance(Catalog(cache=blocked).get("square"), Assignment)


def test_nothing_but_entries_is_left(remembering: AssignmentCache, tmp_path: Path) -> None:
    for _ in range(2):
        Catalog(cache=remembering).all()
    files = sorted(path.name for path in (tmp_path / "cache").iterdir())
    assert len(files) == len(NAMES)
    assert all(name.endswith(".json") for name in files)


@pytest.mark.parametrize(
    ("environment", "expected"),
    [
        ({"XDG_CACHE_HOME": "/c", "HOME": "/h"}, Path("/c/grader")),
        ({"XDG_CACHE_HOME": "relative", "HOME": "/h"}, Path("/h/.cache/grader")),
        ({"HOME": "/h"}, Path("/h/.cache/grader")),
        ({}, None),
    ],
)
def test_the_folder_is_the_users(
    environment: dict[str, str], expected: Path | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cache.os, "environ", environment)
    assert default_cache_folder() == expected


def test_a_remembered_assignment_needs_neither_pydantic_nor_yaml(
    remembering: AssignmentCache, tmp_path: Path
) -> None:
    Catalog(cache=remembering).get("square")
    program = (
        "import sys; from pathlib import Path; from grader.catalog import Catalog; "
        "from grader.catalog.cache import AssignmentCache; "
        f"Catalog(cache=AssignmentCache(Path({str(tmp_path / 'cache')!r}))).get('square'); "
        "print({'pydantic', 'yaml'} & set(sys.modules))"
    )
    root = Path(catalog.__file__).parents[2]
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=root
    )
    assert done.stdout.strip() == "set()"


def test_a_process_remembers_until_the_file_changes(own: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    remembering = Catalog(own, AssignmentMemory())
    first = remembering.get("square")
    with monkeypatch.context() as patched:
        patched.setattr(Catalog, "_document", lambda *_: pytest.fail("a document was read"))
        assert remembering.get("square") is first
    path = own / "square" / "assignment.yaml"
    path.write_bytes(path.read_bytes().replace(b"order: 5", b"order: 6"))
    assert remembering.get("square").order == 6
