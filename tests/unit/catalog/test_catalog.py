"""Reading assignments: what is found, what is refused, and how the refusal reads."""

import json
import re
from pathlib import Path

import pytest

from grader.catalog import Catalog, default_root
from grader.catalog.files import is_there
from grader.checks import problems
from grader.commands.validation import fitting
from grader.contracts.assignment import Assignment, Hints, StartPose, graded_otherwise
from grader.contracts.errors import AssignmentError, UnknownAssignmentError
from grader.contracts.record import from_plain, to_plain
from grader.contracts.text import EMPTY, Text

CHECKLIST = [
    "hello",
    "straight",
    "backward",
    "spin",
    "square",
    "triangle",
    "pentagon",
    "rectangle",
    "square_input",
    "square_parameter",
    "hexagon",
    "octagon",
    "feedback_square",
    "rosclaw",
    "calculation",
    "theory_publisher_timer",
    "theory_keep_publishing",
    "right_triangle",
    "letter_l",
    "figure_eight",
    "two_circles",
    "go_to_goal",
    "patrol",
    "parking",
    "make_package",
    "agent_tools",
    "theory_quadruped",
    "theory_quadrotor",
    "theory_arm",
    "theory_balance",
]

GOOD = """\
id: demo
version: 1
order: 1
title: {zh: 演示, en: Demo}
brief: {zh: 做, en: Do}
check: node
items:
  - id: node
    title: {zh: 节点, en: Node}
    points: 60
    measure: nodes
    low: 1
  - id: log
    title: {zh: 日志, en: Log}
    points: 40
    measure: info_logs
    low: 1
    needs: [node]
"""


def write(root: Path, text: str, name: str = "demo") -> Catalog:
    folder = root / name
    folder.mkdir()
    (folder / "assignment.yaml").write_text(text, encoding="utf-8")
    return Catalog(root)


def test_the_checklist_in_order() -> None:
    assert [each.id for each in Catalog().all()] == CHECKLIST


@pytest.mark.parametrize("name", CHECKLIST)
def test_every_shipped_assignment_is_complete(name: str) -> None:
    catalog = Catalog()
    folder = catalog.folder(name)
    attempts = catalog.wrong_attempts(name)
    assignment = catalog.get(name)
    assert is_there(catalog.own_file(assignment, "starter"))
    assert is_there(catalog.own_file(assignment, "solution"))
    assert len(attempts) >= (1 if assignment.check == "essay" else 5)
    files = {f"{path.name}.zip" if path.is_dir() else path.name for path in folder.glob("wrong/*")}
    assert {attempt.file for attempt in attempts} == files | set(catalog.changed_scripts(name))
    assert all(attempt.high < 100 for attempt in attempts)


@pytest.mark.parametrize("name", CHECKLIST)
def test_an_assignment_survives_the_way_to_the_grading_process(name: str) -> None:
    assignment = Catalog().get(name)
    assert from_plain(Assignment, json.loads(json.dumps(assignment, default=to_plain))) == assignment


def test_one_good_file(tmp_path: Path) -> None:
    assignment = write(tmp_path, GOOD).get("demo")
    assert assignment.max_score == 100
    assert assignment.items[1].needs == ("node",)
    assert assignment.horizon_s == 60.0
    assert assignment.world.cmd_vel_topic == "/turtle1/cmd_vel"


def test_the_teachers_own_hint_and_how_much_is_told(tmp_path: Path) -> None:
    text = GOOD.replace("order: 1", "order: 1\nhints: line").replace(
        "points: 40", "points: 40\n    hint: {zh: 想想, en: Think}"
    )
    for name in ("own", "plain"):
        (tmp_path / name).mkdir()
    read = write(tmp_path / "own", text).get("demo")
    assert read.hints is Hints.LINE
    assert [item.hint for item in read.items] == [EMPTY, Text(zh="想想", en="Think")]
    plain = write(tmp_path / "plain", GOOD).get("demo")
    assert plain.hints is Hints.CHANGE
    assert graded_otherwise(plain, read) == ()  # no new version: it scores the same


def test_an_edit_is_seen_without_a_restart(tmp_path: Path) -> None:
    catalog = write(tmp_path, GOOD)
    assert catalog.get("demo").version == 1
    (tmp_path / "demo" / "assignment.yaml").write_text(GOOD.replace("version: 1", "version: 2"))
    assert catalog.get("demo").version == 2


@pytest.mark.parametrize(
    ("old", "new", "line", "words"),
    [
        ("order: 1", "order: 1\ncolour: red", 4, ("colour", "remove")),
        ("order: 1", "order: 1\nhints: all", 4, ("hints", "fact", "change")),
        ("points: 40", "points: 40\n    hint: {zh: 想想}", 16, ("items.1.hint.en", "required")),
        ("en: Demo}", "en: Go to (2, 9)}", 4, ("title.9)", "quotes around")),
        ("version: 1\n", "", 1, ("version", "required")),
        ("version: 1", "version: one", 2, ("version", "whole number")),
        ("version: 1", "version: 9223372036854775808", 2, ("version", "or less")),
        ("order: 1", "order: 10000000000000000000000000", 3, ("order", "or less")),
        ("zh: 演示, ", "", 4, ("title.zh", "required")),
        ("points: 40", "points: -40", 15, ("items.1.points", "more than 0")),
        ("points: 40", "points: yes", 15, ("items.1.points", "not true or false")),
        ("order: 1", "order: true", 3, ("order", "not true or false")),
        ("points: 40", "points: .nan", 15, ("items.1.points", "finite")),
        ("points: 40", "points: 33.333", 15, ("items.1.points", "two decimals")),
        ("    low: 1\n    needs", "    needs", 13, ("items.1", "band")),
        ("low: 1\n    needs", "low: 3\n    high: 2\n    needs", 13, ("swap",)),
        ("needs: [node]", "needs: [mode]", 18, ("items.1.needs", "'mode'", "no item", "node, log")),
        ("needs: [node]", "needs: [log]", 18, ("items.1.needs", "'log'", "move it up")),
        ("needs: [node]", "needs: node", 18, ("items.1.needs", "write a list")),
        ("check: node", "check: node\nhorizon: 9", 7, ("horizon", "did you mean horizon_s?")),
        ("check: node", "check: node\nhorizon_s: 9s", 7, ("horizon_s", "without a unit")),
        ("check: node", "check: node\npackage: drive", 7, ("package", "name, executable, launch")),
        ("check: node", "check: node\npackage: {launch: a.launch}", 7, ("package.launch", ".launch.py")),
        ("check: node", "check: node\noptions: 3", 7, ("options", "write fields here")),
        ("check: node", "check: node\nfile_patterns: *my*", 7, ("not valid YAML", "begins with *")),
        (
            "check: node",
            "check: node\nhorizon_s: 9\nsteps: [{at_s: 9, call: /a, type: std_srvs/srv/Empty}]",
            8,
            ("steps.0.at_s", "9 s", "earlier at_s"),
        ),
        ("check: node", "check: service\ncalls: [{service: /a}]", 7, ("calls", "steps, and expect")),
        ("needs: [node]", "scaled_by: [mode]", 18, ("items.1.scaled_by", "'mode'", "no other item")),
        ("needs: [node]", "scaled_by: [log]", 18, ("items.1.scaled_by", "'log'", "no other item")),
        ("needs: [node]", "across: worst", 18, ("items.1.across", "two cases")),
        ("id: log", "id: node", 13, ("items.1.id", "rename")),
        ("id: demo", "id: other", 1, ("other", "folder")),
        ("id: log", "id: Log!", 13, ("items.1.id", "small letters")),
        ("order: 1", "order: 1\norder: 2", 4, ("twice", "remove")),
        ("order: 1", "order: [1", 4, ("not valid YAML", "indent")),
        ("order: 1", "? [a, b]\n: 1", 3, ("one word",)),
        ("order: 1", "order: 2026-02-30", 3, ("not valid YAML", "day is out of range")),
        ("order: 1", "order: !!bool maybe", 3, ("not valid YAML", "maybe")),
        ("order: 1", "order: !!timestamp soon", 3, ("not valid YAML",)),
        ("order: 1", "order: !!map [1]", 3, ("not valid YAML", "mapping")),
        ("order: 1", "order: !!map 1", 3, ("not valid YAML", "mapping")),
        ("title: {zh: 演示, en: Demo}", "title: 演示", 4, ("title", "{zh: 标题, en: Title}")),
        ("check: node", "check: node\nhorizon_s: 1e9", 7, ("horizon_s", "600")),
        (
            "check: node",
            "check: node\nwrong:\n  - {file: a.py, score: [0, 5], fails: nothing}",
            8,
            ("wrong.0.fails", "nothing"),
        ),
    ],
)
def test_errors_name_file_line_field_and_fix(
    tmp_path: Path, old: str, new: str, line: int, words: tuple[str, ...]
) -> None:
    assert old in GOOD
    with pytest.raises(AssignmentError) as refusal:
        write(tmp_path, GOOD.replace(old, new, 1)).get("demo")
    message = str(refusal.value)
    assert f"assignment.yaml:{line}:" in message
    assert all(word in message for word in words), message
    in_chinese = refusal.value.message_in("zh")
    assert f"assignment.yaml:{line}:" in in_chinese
    assert re.search(r"[\u4e00-\u9fff]{2}", in_chinese.partition(f":{line}:")[2]), in_chinese


PATH = GOOD.replace(
    "check: node", "check: path\npath:\n  pieces: [{line: 2.0}, {turn: 90}, {goto: [0, 1]}]\n  scale: any"
)


def test_a_path_is_read(tmp_path: Path) -> None:
    path = write(tmp_path, PATH).get("demo").path
    assert path is not None
    assert [piece.kind for piece in path.pieces] == ["line", "turn", "goto"]
    assert (path.any_start, path.any_scale, path.mirror, path.any_direction, path.laps) == (True,) * 5


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("{line: 2.0}", "{line: yes}", "path.pieces.0.line: write a number, not true or false"),
        ("{line: 2.0}", "{line: 2.0, turn: 90}", "path.pieces.0: write a piece as one of"),
        ("{line: 2.0}", "{arc: 90}", "path.pieces.0: arc and radius belong together"),
        ("{line: 2.0}", "{line: 0}", "path.pieces.0: write a piece as one of"),
        ("{line: 2.0}", "{line: 2000}", "path.pieces.0.line"),
        (
            "{line: 2.0}",
            "{circle: 2.0}",
            "circle: unknown field; check its spelling or remove it; there are line, arc, radius, turn, goto",
        ),
        ("scale: any", "scale: big", "path.scale"),
    ],
)
def test_a_path_that_cannot_be_read_is_refused(tmp_path: Path, old: str, new: str, words: str) -> None:
    with pytest.raises(AssignmentError, match=re.escape(words)):
        write(tmp_path, PATH.replace(old, new)).get("demo")


PLACES = GOOD.replace(
    "check: node",
    "check: places\nplaces:\n  visit: [{at: [8, 8]}, {box: [1, 1, 2, 3], hold_s: 1}]\n"
    "world: {start: {x_m: [3, 7], y_m: 5, heading_deg: [-180, 180]}}\n"
    "cases: [{id: a, seed: 1}, {id: b, seed: 2}, {id: c, start: {x_m: 4}}]",
)


def test_places_and_drawn_starts_are_read(tmp_path: Path) -> None:
    assignment = write(tmp_path, PLACES).get("demo")
    assert assignment.places is not None
    circle, box = (goal.region for goal in assignment.places.visit)
    assert (circle.radius_m, box.x_m, box.height_m) == (0.2, 1.5, 2.0)
    one, other, given = (assignment.in_case(case.id).world.start for case in assignment.cases)
    assert one != other
    assert all(3.0 <= each.x_m <= 7.0 and each.y_m == 5.0 for each in (one, other))
    assert given == StartPose(x_m=4.0)
    assert Catalog(tmp_path).get("demo") == assignment


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("{at: [8, 8]}", "{at: [8, 8], box: [1, 1, 2, 2]}", "places.visit.0: write a place as"),
        ("[1, 1, 2, 3]", "[2, 1, 1, 3]", "places.visit.1: write a place as"),
        ("[3, 7]", "[7, 3]", "world.start.x_m: write one number, or"),
        ("[3, 7]", "[1, 2, 3]", "world.start.x_m: write one number, or"),
        ("[3, 7]", "far", "world.start.x_m: write one number, or"),
        ("[3, 7]", "[3, 14]", "world.start.x_m.1: Use 11 or less"),
        ("[3, 7]", "14", "world.start.x_m: Use 11 or less"),
        ("[1, 1, 2, 3]", "[1, 1, 2, 3], within: 1", "places.visit.1: write a place as"),
        ("[3, 7]", "[1.2, 1.8]", "world.start: no start within these bounds"),
        ("{at: [8, 8]}", "{at: [8]}", "places.visit.0.at.1: the list is too short"),
        ("hold_s: 1", "hold: 1", "places.visit.1.hold: unknown field; did you mean hold_s?"),
        ("hold_s: 1", "by_s: 99", "places.visit.1.by_s: the run ends at horizon_s (60 s)"),
        ("order: 1", "order: 1\npath: {pieces: [{line: 0}]}", "path.pieces.0"),
    ],
)
def test_places_that_cannot_be_read_are_refused(tmp_path: Path, old: str, new: str, words: str) -> None:
    text = PLACES.replace("y_m: 5", "y_m: [1.2, 2.8]") if "1.2" in new else PLACES
    with pytest.raises(AssignmentError, match=re.escape(words)) as caught:
        write(tmp_path, text.replace(old, new)).get("demo")
    assert str(caught.value).count("assignment.yaml") == 1


def test_what_is_wrong_in_each_case_is_told_once(tmp_path: Path) -> None:
    wrong = PLACES.replace("hold_s: 1", "hold_s: 60").replace("[8, 8]", "[20, 20]")
    told = [field for field, _ in problems(write(tmp_path, wrong).get("demo")) if field.startswith("places")]
    assert told == ["places.visit.0", "places.visit.1.hold_s"]


def test_odometry_can_be_asked_for(tmp_path: Path) -> None:
    assert write(tmp_path, GOOD + "world: {odometry: true}\n").get("demo").world.odometry


def test_problems_with_the_use_of_a_check_are_told_in_both_languages(tmp_path: Path) -> None:
    catalog = write(tmp_path, GOOD.replace("measure: info_logs", "measure: logs"))
    with pytest.raises(AssignmentError) as refusal:
        fitting(catalog, "demo")
    assert "assignment.yaml:16: items.1.measure: 'logs' is no measure of 'conversation'" in str(refusal.value)
    assert (
        "assignment.yaml:16: items.1.measure: 检查 'conversation' 没有测量值 'logs'"
        in refusal.value.message_in("zh")
    )


@pytest.mark.parametrize("text", ["", "- a list", "just words"])
def test_a_file_without_fields_is_refused(tmp_path: Path, text: str) -> None:
    with pytest.raises(AssignmentError, match="expected fields"):
        write(tmp_path, text).get("demo")


def test_code_in_yaml_is_refused(tmp_path: Path) -> None:
    with pytest.raises(AssignmentError, match="not valid YAML"):
        write(tmp_path, GOOD + "cases: !!python/object/apply:os.getcwd []\n").get("demo")


def test_not_utf8_is_refused(tmp_path: Path) -> None:
    catalog = write(tmp_path, GOOD)
    (tmp_path / "demo" / "assignment.yaml").write_bytes(GOOD.encode("gbk"))
    with pytest.raises(AssignmentError, match="save it as UTF-8"):
        catalog.get("demo")


def test_an_unknown_name_lists_the_known_ones() -> None:
    with pytest.raises(UnknownAssignmentError, match=r"there are: .*square"):
        Catalog().get("thesis")


def test_a_misspelt_name_is_answered_with_the_one_that_is_meant() -> None:
    with pytest.raises(UnknownAssignmentError, match=r"do you mean square\?$"):
        Catalog().get("sqare")


def test_a_missing_wrong_script_is_named(tmp_path: Path) -> None:
    catalog = write(tmp_path, GOOD + "wrong:\n  - {file: lost.py, score: [0, 5], fails: node}\n")
    with pytest.raises(AssignmentError, match=r"assignment\.yaml:20: wrong\.0\.file: no file .*lost\.py"):
        catalog.wrong_attempts("demo")


def test_a_missing_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(AssignmentError, match="is not a folder"):
        Catalog(tmp_path / "nowhere").all()


@pytest.mark.parametrize(
    ("file_name", "expected"),
    [
        ("hello_node.py", "hello"),
        ("straight_mover.py", "straight"),
        ("Backward.py", "backward"),
        ("my_backward_node.py", "backward"),
        ("back.py", "backward"),
        ("go_back2.py", "backward"),
        ("DriveBack.py", "backward"),
        ("square_backward.py", "square"),
        ("callback.py", None),
        ("timer_callback_node.py", None),
        ("feedback_loop.py", "feedback_square"),
        ("my_spin.py", "spin"),
        ("square_mover.py", "square"),
        ("/home/li/走三角形.py", "triangle"),
        ("PENTAGON_v2.PY", "pentagon"),
        ("homework.py", None),
    ],
)
def test_guessing_from_the_file_name(file_name: str, expected: str | None) -> None:
    assert Catalog().guess_assignment(file_name) == expected


def test_the_default_root_holds_the_assignments() -> None:
    assert (default_root() / "square" / "assignment.yaml").is_file()
