"""Wrong attempts that are changes of another script: what is made of them, what is refused and how."""

import re
from pathlib import Path

import pytest

from grader.catalog import Catalog
from grader.catalog.authoring import create
from grader.contracts.errors import AssignmentError

SOLUTION = '"""Right."""\n\nside = 2.0\nfor _ in range(4):\n    drive(side)\n    turn()\n'
ATTEMPT = "  - {{file: bad.py, score: [0, 50], fails: sides, {}}}\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """An assignment without wrong attempts, whose solution is short."""
    made = create(Catalog(tmp_path), "own")
    spec = made / "assignment.yaml"
    text = spec.read_text(encoding="utf-8")
    spec.write_text(text[: text.index("wrong:")] + "wrong:\n", encoding="utf-8")
    (made / "solution.py").write_text(SOLUTION, encoding="utf-8")
    return made


def scripts(folder: Path, *attempts: str) -> dict[str, bytes]:
    with (folder / "assignment.yaml").open("a", encoding="utf-8") as spec:
        spec.writelines(attempts)
    return Catalog(folder.parent).scripts("own")


def refusal(folder: Path, *attempts: str) -> str:
    """Return what is told of these attempts; its line is counted from the first of them."""
    before = (folder / "assignment.yaml").read_text(encoding="utf-8").count("\n")
    with pytest.raises(AssignmentError) as caught:
        scripts(folder, *attempts)
    place = re.search(r"assignment\.yaml:(\d+): (.*)", str(caught.value))
    assert place is not None
    return f"{int(place[1]) - before}: {place[2]}"


@pytest.mark.parametrize(
    ("fields", "text"),
    [
        ('change: {"range(4)": "range(3)"}', SOLUTION.replace("4", "3")),
        ('change: {"range(4)": "range(3)", "2.0": "1.0"}', SOLUTION.replace("4", "3").replace("2.0", "1.0")),
        ('change: {"    turn()\\n": ""}', SOLUTION.replace("    turn()\n", "")),
        ('about: 少了。, change: {"4": "3"}', SOLUTION.replace("4", "3").replace("Right.", "少了。")),
        ('about: "", change: {"4": "3"}', SOLUTION.replace("4", "3").partition("\n\n")[2]),
        ('base: starter.py, change: {"x": "y"}', "y = 1\n"),
    ],
)
def test_a_change_is_carried_out(folder: Path, fields: str, text: str) -> None:
    (folder / "starter.py").write_bytes(b"\xef\xbb\xbfx = 1\r\n")
    assert scripts(folder, ATTEMPT.format(fields))["wrong/bad.py"] == text.encode()


def test_a_patch_changes_whole_lines_and_an_attempt_may_be_the_base_of_another(folder: Path) -> None:
    patch = """\
  - file: patched.py
    score: [0, 50]
    fails: sides
    change: |
      --- solution.py
      +++ patched.py
      @@ -1,3 +1,3 @@
       \"\"\"Right.\"\"\"

      -side = 2.0
      +side = 1.0
      @@
           drive(side)
      -    turn()
      +    turn()
      +    stop()
"""
    made = scripts(folder, patch, ATTEMPT.format('base: patched.py, change: {"stop": "halt"}'))
    patched = SOLUTION.replace("2.0", "1.0") + "    stop()\n"
    assert made["wrong/patched.py"].decode() == patched
    assert made["wrong/bad.py"].decode() == patched.replace("stop", "halt")


@pytest.mark.parametrize(
    ("fields", "told"),
    [
        ('change: {"range(5)": "x"}', "1: wrong.0.change: what is changed does not have 'range(5)'; copy it"),
        ('change: {"side": "x"}', "1: wrong.0.change: 'side' is there 2 times; write more of it"),
        ('change: {"4": "4"}', "1: wrong.0.change: '4' stays as it is; write another text"),
        ('change: {"range(4)": "x", "e(4)": "y"}', "1: wrong.0.change: two of the changes overlap"),
        ('change: {"2.0": 1.0}', '1: wrong.0.change: write {"old text": "new text"}, both in quotes'),
        ('change: {"": "x"}', '1: wrong.0.change: write {"old text": "new text"}'),
        ("change: {}", '1: wrong.0.change: write {"old text": "new text"}'),
        ('change: ""', "1: wrong.0.change: a patch begins with a line @@; add it"),
        ('change: "-side = 2.0"', "1: wrong.0.change: a patch begins with a line @@; add it"),
        ('change: "@@\\n+new"', "1: wrong.0.change: a place of the patch has new lines only"),
        ('change: "@@\\n-side = 2.0\\nx"', "1: wrong.0.change: the patch's line 'x' does not begin with"),
        ('change: "@@\\n-ide = 2.0\\n+x"', "1: wrong.0.change: what is changed does not have 'ide = 2.0"),
        ("base: starter.py", "1: wrong.0.base: it belongs to a change; add change or remove it"),
        ("about: x", "1: wrong.0.about: it belongs to a change"),
        ('about: "a\\"b", change: {"4": "3"}', "1: wrong.0.about: write a sentence without quotes"),
        (
            'base: other.py, change: {"4": "3"}',
            "1: wrong.0.base: no script above this one is 'other.py'; there",
        ),
        ('base: bad.py, change: {"4": "3"}', "1: wrong.0.base: no script above this one is 'bad.py'"),
        (
            'base: starter.py, about: x, change: {"y": "3"}',
            "1: wrong.0.about: what is changed does not begin",
        ),
    ],
)
def test_what_does_not_fit_is_told_by_line_field_and_fix(folder: Path, fields: str, told: str) -> None:
    (folder / "starter.py").write_text("x = y\n", encoding="utf-8")
    assert refusal(folder, ATTEMPT.format(fields)).startswith(told)


def test_the_line_of_a_change_is_told(folder: Path) -> None:
    head = "  - file: bad.py\n    score: [0, 50]\n    fails: sides\n    change:\n"
    told = refusal(folder, head, '      "4": "3"\n', '      "drive(1)": ""\n')
    assert told.startswith("6: wrong.0.change: what is changed does not have 'drive(1)'")


def test_a_name_is_given_once_and_not_to_a_file_as_well(folder: Path) -> None:
    attempt = ATTEMPT.format('change: {"4": "3"}')
    (folder / "wrong").mkdir()
    (folder / "wrong" / "bad.py").write_bytes(b"")
    assert refusal(folder, attempt).startswith("1: wrong.0.change: there is a file ")
    assert refusal(folder, attempt).startswith("1: wrong.1.file: an earlier one is 'bad.py', too; rename one")


def test_all_changes_that_do_not_fit_are_told_at_once_and_large_ones_refused(folder: Path) -> None:
    (folder / "starter.py").write_bytes(b"\xff")
    with pytest.raises(AssignmentError) as caught:
        scripts(
            folder,
            ATTEMPT.format('change: {"no": "3"}'),
            ATTEMPT.format('base: starter.py, change: {"4": "3"}').replace("bad", "worse"),
            ATTEMPT.format(f'change: {{"4": "{"3" * 3_000_000}"}}').replace("bad", "worst"),
        )
    absent, encoded, large = str(caught.value).split("\n")
    assert "wrong.0.change: what is changed does not have 'no'" in absent
    assert "starter.py: this is not UTF-8; save it as UTF-8" in encoded
    assert "wrong.2.change: the changed scripts have more than 2048 KiB together" in large
