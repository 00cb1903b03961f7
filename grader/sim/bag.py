"""A run as a ROS bag: one MCAP file that ``ros2 bag``, Foxglove, Lichtblick and PlotJuggler open.

It is written from what is stored of a run; nothing is run again. The format is MCAP's (specification and registry
at mcap.dev): profile ``ros2``, messages in CDR, their definitions as text. What a channel offers to subscribers is
written as rosbag2's storage plugin reads it where no version is named (rosbag2_storage_mcap, metadata version 8:
integers). The same run makes the same bytes: times are those of the run, and nothing is compressed inside it.
"""

import io
import json
import math
from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any, Final, NamedTuple

from grader.contracts.assignment import EPOCH_NS, WINDOW_M, World
from grader.contracts.errors import RefusedError
from grader.contracts.figure import FigureSketch
from grader.contracts.outcome import LogRecord
from grader.contracts.record import Record
from grader.contracts.trajectory import Trajectory
from grader.geometry.room import outline
from grader.sim.car import UPDATE_NS, fold
from grader.sim.cdr import MAX_SEQUENCE_LENGTH, encode
from grader.sim.interfaces import Types, header, quaternion, stamp, with_interfaces

_FRAME: Final = "world"
_PATH: Final = "nav_msgs/msg/Path"
_VOLATILE, _LATCHED = 2, 1  # rmw's numbers of VOLATILE and TRANSIENT_LOCAL
_FOREVER: Final = "\n    sec: 9223372036\n    nsec: 854775807"
_LINE_STRIP: Final = 4  # visualization_msgs/msg/Marker
_WALL_WIDTH_M: Final = 0.03


class BagContents(Record):
    """What a bag is made of.

    Attributes:
        library: who wrote the file, e.g. ``grader 0.1.0``.
        report: JSON of the report, as its reader may see it. items: the rubric items of it.
        about: further facts by name, as text.
    """

    trajectory: Trajectory
    logs: Sequence[LogRecord]
    world: World
    figure: FigureSketch | None
    report: bytes
    items: Sequence[Mapping[str, Any]]
    library: str
    about: Mapping[str, str]


class _Channel(NamedTuple):
    topic: str
    type: str
    durability: int = _VOLATILE
    depth: int = 10


class _Message(NamedTuple):
    t_ns: int
    channel: _Channel
    values: dict[str, Any]


def bag(run: BagContents) -> bytes:
    """Return the file. Raises RefusedError: the package ``mcap`` is not installed."""
    try:
        from mcap.writer import CompressionType, Writer
    except ImportError as error:
        raise RefusedError("bags_not_installed") from error

    types = with_interfaces(())
    file = io.BytesIO()
    writer = Writer(file, compression=CompressionType.NONE)
    writer.start(profile="ros2", library=run.library)
    channels: dict[_Channel, int] = {}
    for count, (t_ns, channel, values) in enumerate(_in_order(run), start=1):
        if channel not in channels:
            schema = writer.register_schema(channel.type, "ros2msg", definition(channel.type, types).encode())
            metadata = {"offered_qos_profiles": _offered(channel)}
            channels[channel] = writer.register_channel(channel.topic, "cdr", schema, metadata)
        stamp_ns = EPOCH_NS + t_ns
        writer.add_message(
            channels[channel], stamp_ns, encode(channel.type, values, types), stamp_ns, sequence=count
        )
    end_ns = EPOCH_NS + run.trajectory.end_ns
    writer.add_attachment(0, end_ns, "report.json", "application/json", run.report)
    writer.add_metadata("grader", dict(run.about))
    writer.finish()  # type: ignore[no-untyped-call]
    return file.getvalue()


def definition(type_name: str, types: Types) -> str:
    """Return the text of a message and of those it is made of, as MCAP's registry wants it for ``ros2msg``."""
    names = [type_name]
    for name in names:  # grows on the way
        names += [
            base
            for _, text in types.fields[name]
            if (base := _base(text)) in types.fields and base not in names
        ]
    rule = "=" * 80
    first, *others = (_lines(name, types) for name in names)
    parts = (f"{rule}\nMSG: {_short(name)}\n{text}" for name, text in zip(names[1:], others, strict=True))
    return "".join((first, *parts))


def _lines(name: str, types: Types) -> str:
    return "".join(f"{_field(text)} {field}\n" for field, text in types.fields[name])


def _field(text: str) -> str:
    base, bracket, count = text.partition("[")
    base, bound, length = base.partition("<")
    return _short(base) + (f"<={length[:-1]}" if bound else "") + bracket + count


def _base(text: str) -> str:
    return text.partition("[")[0].partition("<")[0]


def _short(name: str) -> str:
    """Return a type's name as one message names another: without ``/msg/``."""
    return name.replace("/msg/", "/")


def _offered(channel: _Channel) -> str:
    return (
        f"- history: 1\n  depth: {channel.depth}\n  reliability: 1\n  durability: {channel.durability}\n"
        f"  deadline:{_FOREVER}\n  lifespan:{_FOREVER}\n  liveliness: 1\n  liveliness_lease_duration:{_FOREVER}\n"
        "  avoid_ros_namespace_conventions: false\n"
    )


def _in_order(run: BagContents) -> list[_Message]:
    """Return all messages in order of time; of one instant in the order of this list."""
    messages = [*_walls(run.world), *_wanted_line(run.figure), *_driven(run.trajectory), *_commands(run)]
    poses = _robot_poses if run.world.kind == "robot" else _poses
    messages += [*poses(run.trajectory), *_logs(run.logs), _rubric(run)]
    return sorted(messages, key=lambda message: message.t_ns)


def _commands(run: BagContents) -> Iterator[_Message]:
    channel = _Channel(run.world.cmd_vel_topic, "geometry_msgs/msg/Twist")
    for t_ns, v_mps, w_radps in run.trajectory.commands:
        yield _Message(t_ns, channel, {"linear": {"x": v_mps}, "angular": {"z": w_radps}})


def _poses(trajectory: Trajectory) -> Iterator[_Message]:
    """Yield the turtle's pose and its transform at each of turtlesim's updates, and at the start."""
    pose_channel = _Channel("/turtle1/pose", "turtlesim/msg/Pose")
    tf_channel = _Channel("/tf", "tf2_msgs/msg/TFMessage", depth=100)
    t_ns = trajectory.t_ns.tolist()
    columns = (trajectory.x_m, trajectory.y_m, trajectory.heading_rad, trajectory.v_mps, trajectory.w_radps)
    samples = list(zip(*(column.tolist() for column in columns), strict=True))
    for now_ns in range(0, trajectory.end_ns + 1, UPDATE_NS):
        latest = max(bisect_right(t_ns, now_ns) - 1, 0)
        x, y, heading, v, w = samples[latest]
        if now_ns - t_ns[latest] >= UPDATE_NS:  # the recorder leaves out a car at rest
            v = w = 0.0
        theta = fold(heading)
        moving = {"linear_velocity": abs(v), "angular_velocity": w}
        yield _Message(now_ns, pose_channel, {"x": x, "y": y, "theta": theta, **moving})
        transform = {
            "header": header(EPOCH_NS + now_ns, _FRAME),
            "child_frame_id": "turtle1",
            "transform": {"translation": {"x": x, "y": y}, "rotation": quaternion(heading)},
        }
        yield _Message(now_ns, tf_channel, {"transforms": [transform]})


def _robot_poses(trajectory: Trajectory) -> Iterator[_Message]:
    """Yield where a robot truly was, and its transform, at each recorded sample."""
    pose_channel = _Channel("/ground_truth/pose", "geometry_msgs/msg/PoseStamped")
    tf_channel = _Channel("/tf", "tf2_msgs/msg/TFMessage", depth=100)
    columns = (trajectory.t_ns, trajectory.x_m, trajectory.y_m, trajectory.heading_rad)
    for t_ns, x, y, heading in zip(*(column.tolist() for column in columns), strict=True):
        head, turned = header(EPOCH_NS + t_ns, _FRAME), quaternion(heading)
        pose = {"position": {"x": x, "y": y}, "orientation": turned}
        yield _Message(t_ns, pose_channel, {"header": head, "pose": pose})
        transform = {
            "header": head,
            "child_frame_id": "base_footprint",
            "transform": {"translation": {"x": x, "y": y}, "rotation": turned},
        }
        yield _Message(t_ns, tf_channel, {"transforms": [transform]})


def _driven(trajectory: Trajectory) -> Iterator[_Message]:
    """Yield the driven line when it begins; after a jump a new line begins."""
    channel = _Channel("/driven_path", _PATH, _LATCHED, 1)
    ends = [0, *trajectory.jumps, len(trajectory)]
    for begin, end in pairwise(ends):
        stride = max(1, math.ceil((end - begin) / (MAX_SEQUENCE_LENGTH - 1)))
        kept = sorted({*range(begin, end, stride), end - 1})
        points = [
            (float(trajectory.x_m[i]), float(trajectory.y_m[i]), float(trajectory.heading_rad[i]))
            for i in kept
        ]
        t_ns = int(trajectory.t_ns[begin])
        yield _Message(t_ns, channel, _path(t_ns, points))


def _wanted_line(figure: FigureSketch | None) -> Iterator[_Message]:
    """Yield the wanted line, as it was laid over the driven one; nothing where there is none."""
    if figure is None or not figure.ideal_m:
        return
    corners = [*figure.ideal_m, *figure.ideal_m[: 1 if figure.ideal_closed else 0]]
    channel = _Channel("/wanted_path", _PATH, _LATCHED, 1)
    yield _Message(0, channel, _path(0, [(x, y, 0.0) for x, y in corners]))


def _walls(world: World) -> Iterator[_Message]:
    if world.window:
        edges = ((0.0, 0.0), (WINDOW_M, 0.0), (WINDOW_M, WINDOW_M), (0.0, WINDOW_M), (0.0, 0.0))
        yield _outline(0, edges)
    for number, solid in enumerate(() if world.room is None else world.room.solids):
        around = [(float(x), float(y)) for x, y in outline(solid)]
        yield _outline(number, (*around, around[0]))


def _outline(number: int, corners: Sequence[tuple[float, float]]) -> _Message:
    marker = {
        "header": header(EPOCH_NS, _FRAME),
        "ns": "walls",
        **({"id": number} if number else {}),
        "type": _LINE_STRIP,
        "pose": {"orientation": {"w": 1.0}},
        "scale": {"x": _WALL_WIDTH_M},
        "color": {"r": 0.4, "g": 0.4, "b": 0.4, "a": 1.0},
        "points": [{"x": x, "y": y} for x, y in corners],
    }
    return _Message(0, _Channel("/walls", "visualization_msgs/msg/Marker", _LATCHED, 1), marker)


def _logs(logs: Sequence[LogRecord]) -> Iterator[_Message]:
    channel = _Channel("/rosout", "rcl_interfaces/msg/Log", _LATCHED, 1000)
    for log in logs:
        text = {"name": _plain(log.name), "msg": _plain(log.message)}
        yield _Message(log.t_ns, channel, {"stamp": stamp(EPOCH_NS + log.t_ns), "level": log.level, **text})


def _rubric(run: BagContents) -> _Message:
    text = json.dumps(list(run.items), ensure_ascii=False)
    channel = _Channel("/rubric", "std_msgs/msg/String", _LATCHED, 1)
    return _Message(run.trajectory.end_ns, channel, {"data": _plain(text)})


def _path(t_ns: int, points: Sequence[tuple[float, float, float]]) -> dict[str, Any]:
    head = header(EPOCH_NS + t_ns, _FRAME)
    poses = [
        {"header": head, "pose": {"position": {"x": x, "y": y}, "orientation": quaternion(heading)}}
        for x, y, heading in points
    ]
    return {"header": head, "poses": poses}


def _plain(text: str) -> str:
    """Return text that a CDR string can hold: a student's may have NULs and halves of characters."""
    return text.replace("\0", "").encode("utf-8", "replace").decode()
