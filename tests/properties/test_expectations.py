"""Whatever a script says, its expectations are judged and explained: no value of a message raises."""

import math
from dataclasses import replace
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from grader.checks.expectations import expected_measures, with_expected_mistakes
from grader.checks.kinds import CHECKS
from grader.contracts.assignment import Assignment, ItemSpec
from grader.contracts.conversation import (
    Conversation,
    Expectation,
    Message,
    Party,
    Sent,
    Served,
    Step,
    TurtleSample,
)
from grader.contracts.outcome import LogRecord, RunOutcome, RunStatus
from grader.contracts.scoring import Run
from grader.contracts.text import EMPTY
from tests.unit.checks.trajectories import once_each

FLOATS = st.floats(allow_nan=True, allow_infinity=True)
SCALARS = st.one_of(
    FLOATS, st.integers(-(2**63), 2**64 - 1), st.text(max_size=20), st.booleans(), st.binary(max_size=8)
)
VALUES = st.dictionaries(
    st.sampled_from(["data", "sum", "a", "b", "sequence", "name"]),
    st.one_of(SCALARS, st.lists(SCALARS, max_size=5), st.dictionaries(st.just("x"), SCALARS)),
)
TIMES = st.lists(st.integers(0, 10**10), max_size=8).map(sorted)
STEPS = (
    Step(id="calls", kind="call", target="/add", type="example_interfaces/srv/AddTwoInts"),
    Step(id="goals", kind="goal", target="/fib", type="example_interfaces/action/Fibonacci"),
    Step(id="sets", kind="set", target="/node", values={"speed": 1.0}),
    Step(id="gets", kind="get", target="/node", names=("speed",)),
    Step(id="says", kind="publish", target="/in", type="std_msgs/msg/Int32"),
    Step(id="serves", kind="serve", target="/add", type="example_interfaces/srv/AddTwoInts"),
)
INT = "std_msgs/msg/Int32"
WANTED = (
    Expectation(kind="topic", target="/out", type=INT, values={"data": "= n"}, rate_hz=2.0),
    Expectation(kind="topic", target="/out", type=INT, increasing="data", that="out.data > before.data"),
    Expectation(kind="topic", target="/out", step="says", type=INT, values={"data": "= 2 * in.data"}),
    Expectation(kind="answer", target="calls", values={"sum": "= in.a + in.b"}, within_s=1.0),
    Expectation(kind="goal", target="goals", status="succeeded", that="out.a", feedback_that="before.a"),
    Expectation(kind="set", target="sets", successful=False, reason="~*range*"),
    Expectation(kind="served", target="serves", values={"a": 3}, that="out.a > sqrt(out.b)"),
    Expectation(kind="frame", target="turtle1", parent="world", translation=("= turtle1.x", 0, "= 1 / 0")),
    Expectation(kind="frame", target="turtle1", parent="world", yaw_deg="= t"),
    Expectation(kind="frame", target="turtle1", parent="world", rotation=("= 'x'", 0.0, 0.0, 1.0), rate_hz=5.0),
    Expectation(kind="log", target="= f'{in.data}'", step="says"),
    Expectation(kind="log", target="~*#*", rate_hz=2.0, least_s=0.1),
    Expectation(kind="turtle", target="turtle1", x=1.0, y=2.0, heading_deg=90.0, pen=(1, 2, 3)),
    Expectation(kind="moved", target="says", ahead_m="= in.data", turned_deg="= 1 / 0"),
    Expectation(kind="turtle", target="turtle1", that="hypot(turtle1.x, turtle1.y) < 2"),
)  # fmt: skip
ITEM = ItemSpec(
    id="one", title=EMPTY, points=100.0, measure="expected.one", low=100.0, ramp=100.0, expect=WANTED
)
TASK = Assignment(
    id="demo", version=1, order=1, title=EMPTY, brief=EMPTY, check="conversation", items=(ITEM,), steps=STEPS
)


@st.composite
def conversations(draw: st.DrawFn) -> Conversation:
    def message(t_ns: int) -> Message:
        return Message(t_ns, draw(st.one_of(st.none(), VALUES)), 1)

    def transform(t_ns: int) -> Message:
        x, y, z, w = (draw(FLOATS) for _ in range(4))
        one = {"translation": {"x": x, "y": y, "z": z}, "rotation": {"x": x, "y": y, "z": z, "w": w}}
        names = {
            "header": {"frame_id": draw(st.sampled_from(["world", "turtle1", ""]))},
            "child_frame_id": "turtle1",
        }
        return Message(t_ns, {"transforms": [{**names, "transform": one}]}, 1)

    def sent(step: Step) -> Sent:
        return Sent(
            step=step.id,
            n=0,
            values=draw(VALUES),
            sent_ns=draw(st.one_of(st.none(), st.just(10**9))),
            answered_ns=draw(st.one_of(st.none(), st.integers(10**9, 10**10))),
            answer=draw(st.one_of(st.none(), VALUES)),
            accepted=draw(st.one_of(st.none(), st.booleans())),
            feedback=tuple(map(message, draw(TIMES))),
            status=draw(st.text(max_size=9)),
        )

    sample = TurtleSample(0, 1.0, 2.0, 0.5, pen=(1, 2, 3), pen_off=False)
    return Conversation(
        exchanges=tuple(sent(step) for step in STEPS if step.kind not in ("set", "get", "serve")),
        heard={"/out": tuple(map(message, draw(TIMES))), "/tf": tuple(map(transform, draw(TIMES)))},
        parties=(Party(id=1, kind="publisher", node="/node", name="/out", type="std_msgs/msg/Int32"),),
        served=tuple(Served(step="serves", t_ns=t_ns, values=draw(VALUES)) for t_ns in draw(TIMES)),
        turtles={"turtle1": (sample, replace(sample, t_ns=10**9))},
    )


@given(conversations(), st.lists(st.text(max_size=30), max_size=5))
def test_nothing_that_a_script_says_raises(talk: Conversation, texts: list[str]) -> None:
    logs = tuple(
        LogRecord(t_ns=i * 10**9, level=20, name="node", message=each) for i, each in enumerate(texts)
    )
    outcome = RunOutcome(status=RunStatus.INTERRUPTED, duration_ns=10**10, logs=logs, nodes=("/node",))
    run = Run(trajectory=once_each([(0.0, 0.0, 1.0)]), outcome=outcome, conversation=talk)
    measures = expected_measures(TASK, run)
    share: Any = measures["expected.one"].value
    assert 0.0 <= share <= 100.0
    assert math.isfinite(share)
    assert with_expected_mistakes((), TASK, run, measures)
    assert CHECKS["conversation"].sketch(TASK, run).view in ("log", "talk")
