"""What is wrong with steps and expectations is told with its place, and how to mend it."""

from pathlib import Path

import pytest

from grader.catalog import Catalog
from grader.contracts.conversation import Expectation, Step
from grader.contracts.errors import AssignmentError

GOOD = """id: demo
version: 1
order: 1
title: {zh: a, en: a}
brief: {zh: a, en: a}
check: conversation
horizon_s: 10
steps:
  - {id: sums, at_s: 2, call: /add, type: example_interfaces/srv/AddTwoInts, values: {a: "= draw(1, 6)", b: 2}}
  - {id: moves, publish: /cmd, type: geometry_msgs/msg/Twist, values: {linear: {x: 1.0}}, count: 3, every_s: 0.5}
  - {id: asked, get: /node, names: [speed]}
items:
  - id: one
    title: {zh: a, en: a}
    points: 100
    expect:
      - {answer: sums, values: {sum: "= in.a + in.b"}, within_s: 0.5}
      - {topic: /out, type: std_msgs/msg/Int32, after: moves, values: {data: 3}, count: [2, null]}
      - {node: /node, log: "~went #"}
      - {parameter: speed, of: asked, type: double}
"""


def assignment(tmp_path: Path, text: str) -> Catalog:
    folder = tmp_path / "demo"
    folder.mkdir()
    (folder / "assignment.yaml").write_text(text, encoding="utf-8")
    return Catalog(tmp_path)


def test_steps_and_expectations_become_contracts(tmp_path: Path) -> None:
    task = assignment(tmp_path, GOOD).get("demo")
    assert task.steps[1] == Step(
        id="moves",
        kind="publish",
        target="/cmd",
        type="geometry_msgs/msg/Twist",
        at_ns=1_000_000_000,
        values={"linear": {"x": 1.0}},
        every_ns=500_000_000,
        count=3,
    )
    expected = task.items[0].expect
    assert expected[0] == Expectation(
        kind="answer", target="sums", values={"sum": "= in.a + in.b"}, within_s=0.5
    )
    assert (expected[1].step, expected[1].count) == ("moves", (2, None))
    assert [(one.kind, one.node) for one in expected[2:]] == [("log", "/node"), ("parameter", None)]
    assert task.items[0].measure == "expected.one"


@pytest.mark.parametrize(
    ("old", "new", "line", "said"),
    [
        ("call: /add", "call: add", 9, "steps.0.call: write a name such as /turtle1/cmd_vel"),
        ("call: /add, ", "", 9, "give one of publish, call, goal, set, get, serve"),
        ("srv/AddTwoInts", "srv/AddTwo", 9, "steps.0.type: there is no type 'example_interfaces/srv/AddTwo'"),
        ("b: 2", "c: 2", 9, "steps.0.values.c: there is no field 'c'; there are: a, b"),
        ("linear: {x", "linear: {xx", 10, "steps.1.values.linear.xx: there is no field 'xx'"),
        ("draw(1, 6)", "drew(1, 6)", 9, "there is no function drew"),
        ("draw(1, 6)", "in.a", 9, "a formula knows no 'in' here; there are n"),
        ("at_s: 2", "at_s: 20", 9, "the run ends at horizon_s"),
        ("names: [speed]", "values: {speed: 1}", 11, "steps.2.values: a step of get has no such field"),
        ("id: asked", "id: sums", 11, "steps.2.id: an earlier one is 'sums'"),
        ("count: 3, ", "count: 1000, ", 8, "more than 1000"),
        (
            "answer: sums",
            "answer: moves",
            17,
            "items.0.expect.0.answer: there is no call step with the id 'moves'",
        ),
        ("answer: sums", "answers: sums", 17, "say what is expected: one of topic, answer"),
        (
            "{sum: ",
            "{total: ",
            17,
            "items.0.expect.0.values.total: there is no field 'total'; there are: sum",
        ),
        ("within_s: 0.5}", "within_m: 0.5}", 17, "did you mean within_s?"),
        ("in.a + in.b", "in.a +", 17, "this formula is not understood"),
        (
            "in.a + in.b",
            "foo + 1",
            17,
            "a formula knows no 'foo' here; there are n, t, in, out, sent, before",
        ),
        ("msg/Int32", "msg/Int33", 18, "items.0.expect.1.type: there is no type 'std_msgs/msg/Int33'"),
        ("[2, null]", "[3, 2]", 18, "write a whole number such as 3 (exactly), [2, 4], or [2, null]"),
        ("of: asked", "of: sums", 20, "there is no get step with the id 'sums'"),
        ("of: asked, ", "", 20, "give of (the id of a get step), or node"),
        ("points: 100\n", "points: 100\n    measure: alive\n    low: 1\n", 18, "one of the two"),
    ],
)
def test_what_is_wrong_is_told_with_its_place(
    tmp_path: Path, old: str, new: str, line: int, said: str
) -> None:
    assert old in GOOD
    with pytest.raises(AssignmentError) as refusal:
        assignment(tmp_path, GOOD.replace(old, new, 1)).get("demo")
    assert said in str(refusal.value)
    assert f"assignment.yaml:{line}: " in str(refusal.value)
    assert refusal.value.message_in("zh") != str(refusal.value)
