"""A new assignment starts from a working example."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from grader.catalog import Catalog
from grader.catalog.authoring import create
from grader.checks import problems
from grader.checks.kinds import CHECKS, TEXT_CHECKS
from grader.commands.validation import fitting
from grader.contracts.errors import AssignmentError


def test_an_assignment_is_no_folder_of_assignments(tmp_path: Path) -> None:
    folder = create(Catalog(tmp_path), "heptagon")
    with pytest.raises(AssignmentError, match="each in a folder of its own"):
        Catalog(folder).all()


def test_the_skeleton_is_complete(tmp_path: Path) -> None:
    catalog = Catalog(tmp_path)
    folder = create(catalog, "heptagon")
    task = catalog.get("heptagon")
    assert problems(task) == ()
    assert (task.order, task.max_score) == (1, 100)
    assert catalog.own_file(task, "starter").is_file()
    assert len(catalog.wrong_attempts("heptagon")) == len(catalog.changed_scripts("heptagon")) == 2
    text = (folder / "assignment.yaml").read_text(encoding="utf-8")
    assert "$" not in text
    kinds = re.search(r"^check: \w+ # (.*); for texts \(input: text\): (.*)$", text, re.MULTILINE)
    assert kinds is not None
    assert [set(names.split(", ")) for names in kinds.groups()] == [set(CHECKS), set(TEXT_CHECKS)]
    create(catalog, "nonagon")
    assert [each.id for each in catalog.all()] == ["heptagon", "nonagon"]
    (folder / "assignment.yaml").write_text("id: 1", encoding="utf-8")
    create(catalog, "decagon")  # whatever is wrong with another one
    assert catalog.get("decagon").order == 3


@pytest.mark.parametrize("like", ["letter_l", "rosclaw", "theory_publisher_timer"])
def test_a_new_assignment_may_begin_as_a_copy_of_another(tmp_path: Path, like: str) -> None:
    source = Catalog().get(like)
    create(Catalog(tmp_path), "first")
    create(Catalog(tmp_path), "mine", Catalog().folder(like))
    copy = Catalog(tmp_path).get("mine")
    assert problems(copy) == ()
    assert copy == replace(source, id="mine", order=2, version=1, file_patterns=copy.file_patterns)
    assert copy.file_patterns in ((), ("*mine*",))
    assert Catalog(tmp_path).scripts("mine") == Catalog().scripts(like)


@pytest.mark.parametrize("name", ["Square", "../up", "9sides", "", "a b", "x" * 41])
def test_names_that_do_not_do(tmp_path: Path, name: str) -> None:
    with pytest.raises(AssignmentError, match="letters"):
        create(Catalog(tmp_path), name)


def test_an_existing_folder_is_left_alone(tmp_path: Path) -> None:
    create(Catalog(tmp_path), "heptagon")
    with pytest.raises(AssignmentError, match="exists already"):
        create(Catalog(tmp_path), "heptagon")


@pytest.mark.parametrize(
    ("old", "new", "field"),
    [
        ("low: 87", "low: 187", "items.1"),
        ("measure: settled", "measures: settled", "items.3"),
        ("score: [70, 90]", "score: [90, 70]", "wrong.0"),
        ("file: three_sides.py", "file: three_sides.txt", "ends in .py"),
        ("points: 10", "points: 0", "items.3.points"),
    ],
)
def test_a_broken_spec_is_named_with_its_line(tmp_path: Path, old: str, new: str, field: str) -> None:
    catalog = Catalog(tmp_path)
    path = create(catalog, "heptagon") / "assignment.yaml"
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(AssignmentError, match=field) as caught:
        catalog.get("heptagon")
    assert str(path) in str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        (
            "measure: corner_deg",
            "measure: corner_degrees",
            ":28: items.1.measure: 'corner_degrees' is no measure",
        ),
        ("{sides: 4, side_m: 2.0}", "{sides: 4}", ":11: options.side_m: missing"),
        ("{sides: 4, side_m: 2.0}", "{sides: 2, side_m: 2.0}", ":11: options.sides: must be a whole number"),
        (
            "{sides: 4, side_m: 2.0}",
            "{sides: 4, side_m: 2.0, corners_deg: [135, 135, 90]}",
            ":11: options.corners_deg: the check 'polygon' has only the options sides, side_m, other_side_m",
        ),
        ("check: polygon", "check: polygone", ":10: check: unknown check 'polygone'"),
    ],
)
def test_what_does_not_fit_the_check_is_named_with_its_line(
    tmp_path: Path, old: str, new: str, place: str
) -> None:
    catalog = Catalog(tmp_path)
    path = create(catalog, "heptagon") / "assignment.yaml"
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(AssignmentError) as caught:
        fitting(catalog, "heptagon")
    assert f"{path}{place}" in str(caught.value)
    assert str(caught.value).count("\n") == 0  # one mistake, one message
