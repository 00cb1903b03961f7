"""A run as a ROS bag: readers of other projects find in it what was recorded, and a run makes the same bytes."""

import io
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from grader.contracts.assignment import EPOCH_NS, World
from grader.contracts.figure import FigureSketch
from grader.contracts.outcome import LogRecord
from grader.contracts.trajectory import Command, Trajectory
from grader.sim.bag import BagContents, bag, definition
from grader.sim.car import UPDATE_NS
from grader.sim.interfaces import with_interfaces
from tests.examples import examples

TRIANGLE = FigureSketch(ideal_m=((1.0, 1.0), (2.0, 1.0), (1.5, 2.0)))


def _trajectory(samples: list[tuple[int, float, float, float]], end_ns: int, **more: Any) -> Trajectory:
    t, x, y, heading = (np.array(column) for column in zip(*samples, strict=True))
    speeds = {"v_mps": np.full(len(t), 0.5), "w_radps": np.zeros(len(t))}
    return Trajectory(
        t_ns=t.astype(np.int64), x_m=x.astype(float), y_m=y.astype(float), heading_rad=heading.astype(float),
        end_ns=end_ns, **speeds, **more,
    )  # fmt: skip


def _contents(trajectory: Trajectory, *logs: LogRecord, figure: FigureSketch | None = None) -> BagContents:
    items = [{"id": "shape", "earned": 3.0, "points": 5.0}]
    return BagContents(
        trajectory=trajectory, logs=logs, world=World(), figure=figure, report=b'{"score": 3.0}', items=items,
        library="grader 0", about={"assignment": "square"},
    )  # fmt: skip


DRIVE = _trajectory(
    [
        (0, 5.5, 5.5, 0.0),
        *((k * UPDATE_NS, 5.5 + k / 100, 5.5, 7.0) for k in range(1, 5)),
        (9 * UPDATE_NS, 1.0, 2.0, 0.0),
    ],
    10 * UPDATE_NS,
    jumps=(5,),
    commands=(Command(0, 0.5, 0.0), Command(3 * UPDATE_NS, 0.0, -1.5)),
)


def test_rosbags_reads_what_was_recorded(tmp_path: Path) -> None:
    """Counts, times, poses, commands, log, paths on either side of the jump: as another reader sees them."""
    log = LogRecord(t_ns=UPDATE_NS, level=30, name="driver", message="转弯\0 \ud800!")
    path = tmp_path / "run.mcap"
    path.write_bytes(bag(_contents(DRIVE, log, figure=TRIANGLE)))
    with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
        seen: dict[str, list[tuple[int, Any]]] = {}
        for connection, stamp, data in reader.messages():
            message = reader.deserialize(data, connection.msgtype)
            seen.setdefault(connection.topic, []).append((stamp - EPOCH_NS, message))
    poses = seen["/turtle1/pose"]
    assert [stamp for stamp, _ in poses] == [k * UPDATE_NS for k in range(11)]
    assert [round(float(pose.x), 4) for _, pose in poses] == [5.5, 5.51, 5.52, 5.53, *([5.54] * 5), 1.0, 1.0]
    assert poses[1][1].theta == pytest.approx(7.0 - 2 * np.pi)
    assert [float(pose.linear_velocity) for _, pose in poses][4:7] == [0.5, 0.0, 0.0]
    turning = seen["/turtle1/cmd_vel"][1]
    assert (turning[0], turning[1].angular.z) == (3 * UPDATE_NS, -1.5)
    assert seen["/rosout"][0][1].msg == "转弯 ?!"
    assert [(stamp, len(line.poses)) for stamp, line in seen["/driven_path"]] == [(0, 5), (9 * UPDATE_NS, 1)]
    assert [pose.pose.position.x for pose in seen["/wanted_path"][0][1].poses] == [1.0, 2.0, 1.5, 1.0]
    assert len(seen["/walls"][0][1].points) == 5
    transform = seen["/tf"][2][1].transforms[0]
    assert (transform.header.frame_id, transform.child_frame_id) == ("world", "turtle1")
    assert transform.header.stamp.sec * 10**9 + transform.header.stamp.nanosec == EPOCH_NS + 2 * UPDATE_NS
    assert json.loads(seen["/rubric"][0][1].data)[0]["earned"] == 3.0


def test_a_long_rubric_is_kept_whole() -> None:
    """Ten cases of ten items have some 700 characters each."""
    items = [{"id": f"item{k}", "message": "长" * 700} for k in range(100)]
    reader = make_reader(io.BytesIO(bag(replace(_contents(DRIVE), items=items))))
    ((_, _, message),) = reader.iter_messages(topics=["/rubric"])
    assert len(message.data) > 200_000


def test_a_bag_tells_what_its_channels_offer_and_carries_the_report() -> None:
    """`ros2 bag play` needs the offered QoS; the report and what was graded travel along."""
    reader = make_reader(io.BytesIO(bag(_contents(DRIVE))))
    summary = reader.get_summary()
    assert summary is not None
    assert reader.get_header().profile == "ros2"
    offered = {each.topic: each.metadata["offered_qos_profiles"] for each in summary.channels.values()}
    assert "durability: 2" in offered["/turtle1/pose"]
    assert "durability: 1" in offered["/driven_path"]
    assert [each.data for each in reader.iter_attachments()] == [b'{"score": 3.0}']
    assert [each.metadata for each in reader.iter_metadata()] == [{"assignment": "square"}]


@pytest.mark.parametrize(
    "name", ["nav_msgs/msg/Path", "rcl_interfaces/msg/Log", "visualization_msgs/msg/Marker"]
)
def test_definitions_are_those_that_ros_has(name: str) -> None:
    """Field by field as rosbags, which reads upstream's files, knows them."""
    known = get_typestore(Stores.ROS2_HUMBLE).fielddefs
    first, *others = definition(name, with_interfaces(())).split("=" * 80 + "\nMSG: ")
    for type_name, text in ((name, first), *((part.split("\n", 1)) for part in others)):
        for full, (_, fields) in get_types_from_msg(text, type_name).items():
            assert fields == known[full][1]


SAMPLES = st.lists(
    st.tuples(st.integers(1, 40), st.floats(-20, 20), st.floats(-20, 20), st.floats(-50, 50)), max_size=30
)


@settings(max_examples=examples(10))
@given(SAMPLES, st.integers(0, 3000), st.lists(st.text(max_size=20), max_size=5), st.data())
def test_every_recording_makes_an_ordered_file(
    steps: list[tuple[int, float, float, float]], rest: int, texts: list[str], data: st.DataObject
) -> None:
    """Jumps, one sample, a long rest, no command, odd text: valid, in order of time, twice the same."""
    update, samples = 0, [(0, 5.5, 5.5, 0.0)]
    for later, x, y, heading in steps:
        update += later
        samples.append((update * UPDATE_NS, x, y, heading))
    jumps = tuple(i for i in range(1, len(samples)) if data.draw(st.booleans()))
    trajectory = _trajectory(samples, (update + rest) * UPDATE_NS, jumps=jumps)
    logs = [LogRecord(t_ns=i, level=20, name="n", message=text) for i, text in enumerate(texts)]
    contents = _contents(trajectory, *logs)
    content = bag(contents)
    stamps = [
        message.log_time
        for _, _, message in make_reader(io.BytesIO(content)).iter_messages(log_time_order=False)
    ]
    assert stamps == sorted(stamps)
    assert content == bag(contents)


def test_a_long_drive_is_thinned_for_the_line_only() -> None:
    """A sequence has at most so many elements; poses are all there, and the line ends where the drive does."""
    count = 4_500
    samples = [(k * UPDATE_NS, k / 1000, 0.0, 0.0) for k in range(count)]
    content = bag(_contents(_trajectory(samples, (count - 1) * UPDATE_NS)))
    counts: dict[str, int] = {}
    last: Any = None
    types = get_typestore(Stores.ROS2_HUMBLE)
    for schema, channel, message in make_reader(io.BytesIO(content)).iter_messages():
        counts[channel.topic] = counts.get(channel.topic, 0) + 1
        if channel.topic == "/driven_path" and schema is not None:
            last = types.deserialize_cdr(message.data, schema.name).poses
    assert counts["/turtle1/pose"] == count
    assert len(last) <= 4_096
    assert last[-1].pose.position.x == pytest.approx((count - 1) / 1000)
