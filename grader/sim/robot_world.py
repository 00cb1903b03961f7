"""A TurtleBot3 Burger in a room, as a script meets it: the topics of its simulation in Gazebo on Humble."""

import math
from collections.abc import Callable, Sequence
from typing import Any, Final, NamedTuple

import numpy as np

from grader.contracts.assignment import Room, World
from grader.contracts.errors import AssignmentError
from grader.contracts.robot import LEAST_RANGE_M, MOST_RANGE_M, SCANNER_X_M
from grader.formats.png import png_of
from grader.sim import robot_messages as messages
from grader.sim.frames import MESSAGE_EVENT, Entity, Event
from grader.sim.recorder import ReceivedCommands, Recorder
from grader.sim.robot import (
    BEAT_S,
    DRIVE_BEATS,
    ROUGH_SCAN_NOISE_M,
    SCAN_BEATS,
    SCAN_NOISE_M,
    beat_time_ns,
    clamp_twist,
    last_beat_at,
)
from grader.sim.robot_body import RobotBody
from grader.sim.room_camera import HEIGHT, WIDTH, RoomCamera
from grader.sim.scanner import ANGLES_RAD, RoomScanner
from grader.sim.simulated_world import SimulatedWorld

TWIST: Final = "geometry_msgs/msg/Twist"
NODES: Final = (
    "/gazebo",
    "/robot_state_publisher",
    "/turtlebot3_diff_drive",
    "/turtlebot3_imu",
    "/turtlebot3_joint_state",
    "/turtlebot3_laserscan",
)
SIM_START_NS: Final = 12_625_000_000
"""What the simulation's clock shows when the script starts: Gazebo has been running for a while."""

CAMERA: Final = "/camera/image_raw"
CLOCK_BEATS: Final = 6
CAMERA_BEATS: Final = 6
IMU_BEATS: Final = 1
_SETTLING_NS: Final = 100_000_000
_IMU_STREAM: Final = 1


class _Feed(NamedTuple):
    """What is published on a topic.

    Attributes:
        beats: beats from one message to the next; 0: one message for each subscription, TRANSIENT_LOCAL.
        build: returns the message of an instant.
        reliable: else it is offered BEST_EFFORT, as sensor data are.
    """

    type: str
    beats: int
    build: Callable[[int], bytes]
    reliable: bool = True


class RobotWorld(SimulatedWorld):
    """The robot, its room and its sensors. Messages are built only for those who listen.

    Stamps are those of the simulation's clock, which ``/clock`` tells, as in Gazebo; the script's own clock is the
    system's unless it sets `use_sim_time`.
    """

    def __init__(self, body: RobotBody, recorder: Recorder, world: World, horizon_ns: int) -> None:
        if world.room is None:
            raise AssignmentError("a robot needs world.room")
        super().__init__(ReceivedCommands(recorder), world.cmd_vel_topic)
        self._body = body
        self._recorder = recorder
        self._world = world
        self._room: Room = world.room
        self._horizon_ns = horizon_ns
        self._scanner = RoomScanner(world.room)
        # A stream for each sensor: what one of them shows does not depend on who listens to another.
        self._scan_noise = np.random.RandomState(world.seed)
        self._imu_noise = np.random.RandomState([world.seed, _IMU_STREAM])
        self._noise_m = ROUGH_SCAN_NOISE_M if world.profile == "rough" else SCAN_NOISE_M
        self._camera: RoomCamera | None = None
        self._seen: tuple[int, bytes] = (-1, b"")  # the last picture, and its instant
        self._felt: tuple[int, float] = (0, 0.0)  # beat of the last IMU message, and the speed then
        self._beat = 0
        self._heard: tuple[tuple[str, _Feed], ...] = ()
        self._heard_at = -1
        feeds = {
            "/odom": _Feed("nav_msgs/msg/Odometry", DRIVE_BEATS, self._odometry),
            "/tf": _Feed("tf2_msgs/msg/TFMessage", DRIVE_BEATS, self._transforms),
            "/tf_static": _Feed("tf2_msgs/msg/TFMessage", 0, messages.static_transforms),
            "/joint_states": _Feed("sensor_msgs/msg/JointState", DRIVE_BEATS, self._joint_states),
            "/scan": _Feed("sensor_msgs/msg/LaserScan", SCAN_BEATS, self._scan, reliable=False),
            "/imu": _Feed("sensor_msgs/msg/Imu", IMU_BEATS, self._imu, reliable=False),
            CAMERA: _Feed("sensor_msgs/msg/Image", CAMERA_BEATS, self._image),
            f"{CAMERA}/compressed": _Feed("sensor_msgs/msg/CompressedImage", CAMERA_BEATS, self._compressed),
            "/clock": _Feed("rosgraph_msgs/msg/Clock", CLOCK_BEATS, messages.clock, reliable=False),
        }
        self._feeds = {world.topics.get(topic, topic): feed for topic, feed in feeds.items()}

    @property
    def steps_run(self) -> int:
        """Physics steps computed."""
        return self._body.steps_run

    def appear(self) -> None:
        """Build the room, with the robot at rest in the start pose; InfrastructureError."""
        start = self._world.start
        rough_seed = self._world.seed if self._world.profile == "rough" else None
        pose = (start.x_m, start.y_m, math.radians(start.heading_deg))
        self._body.reset(self._recorder, pose, self._room, rough_seed=rough_seed)

    def graph(self) -> dict[str, Any]:
        """Return START's ``world``."""
        return {
            "publishes": [[topic, feed.type] for topic, feed in self._feeds.items()],
            "subscribes": [[self._world.cmd_vel_topic, TWIST]],
            "services": [],
            "nodes": list(NODES),
            "qos": {topic: [feed.reliable, feed.beats == 0] for topic, feed in self._feeds.items()},
        }

    def type_of(self, topic: str) -> str | None:
        """Return the type the world publishes or subscribes to on `topic`, None when it does neither."""
        if topic == self._world.cmd_vel_topic:
            return TWIST
        feed = self._feeds.get(topic)
        return None if feed is None else feed.type

    def qos_note(self, entity: Entity) -> str | None:
        """Return the note on a subscription whose QoS the world's publisher on its topic does not offer."""
        feed = self._feeds[entity.name]
        if entity.reliable and not feed.reliable:
            return "sensor_qos"
        return "incompatible_qos" if entity.transient_local and feed.beats else None

    def listen(self, topic: str, identity: int, t_ns: int, *, late: bool = False) -> None:
        """Connect a subscription to its topic; what is kept for late ones comes at once."""
        self.advance(t_ns)
        feed = self._feeds[topic]
        if feed.beats:
            self.outbox.subscribe(topic, identity)
        elif late:
            self.outbox.add(Event(MESSAGE_EVENT, identity, 0, t_ns, feed.build(SIM_START_NS)))

    def command(
        self, topic: str, times_ns: Sequence[int], linear_x: float, linear_y: float, angular_z: float
    ) -> None:
        """Take a message on the command topic: it acts from the next tick of the drive until the next command."""
        obeyed = clamp_twist(linear_x, angular_z)
        for t_ns in times_ns:
            self.advance(t_ns)
            update = last_beat_at(t_ns) // DRIVE_BEATS
            self.received.take([t_ns], [update], (linear_x, linear_y, angular_z), obeyed)
            self._body.command(obeyed[0], obeyed[1])

    def next_due(self) -> int | None:
        """Return the instant of the next message for somebody, None when nobody listens."""
        if self._heard_at != self.outbox.changes:
            self._heard_at = self.outbox.changes
            self._heard = tuple(
                (topic, feed) for topic, feed in self._feeds.items() if self.outbox.has_listeners(topic)
            )
        due = self._due_beat()
        return None if due is None else beat_time_ns(due)

    def _due_beat(self) -> int | None:
        beat = self._beat
        return min(((beat // feed.beats + 1) * feed.beats for _, feed in self._heard), default=None)

    def advance(self, t_ns: int) -> None:
        """Run until `t_ns`, through every beat that publishes to somebody, but never past the horizon."""
        end_ns = min(t_ns, self._horizon_ns)
        while (due_ns := self.next_due()) is not None and due_ns <= end_ns:
            beat = self._due_beat() or 0
            self._body.advance(due_ns)
            self._beat = beat
            for topic, feed in self._heard:
                if beat % feed.beats == 0:
                    self.outbox.publish(topic, due_ns, feed.build(SIM_START_NS + due_ns))
        self._body.advance(end_ns)
        self._beat = max(self._beat, last_beat_at(end_ns))

    def settle(self, from_ns: int, until_ns: int) -> int:
        """Run the world on without the script until the robot rests; its last command holds for ever."""
        now_ns = min(from_ns, until_ns)
        self.advance(now_ns)
        while now_ns < until_ns and not self._body.resting:
            now_ns = min(now_ns + _SETTLING_NS, until_ns)
            self.advance(now_ns)
        return now_ns

    def finish(self, end_ns: int) -> None:
        """Drive up to `end_ns`, when the episode ended, and record the last sample."""
        self.advance(end_ns)
        self._body.observe()
        if self._camera is not None:
            self._camera.close()
            self._camera = None

    def _odometry(self, t_ns: int) -> bytes:
        odometry = self._body.odometry
        return messages.odometry(
            t_ns, (odometry.x_m, odometry.y_m, odometry.heading_rad), odometry.v_mps, odometry.w_radps
        )

    def _transforms(self, t_ns: int) -> bytes:
        odometry = self._body.odometry
        return messages.transforms(t_ns, (odometry.x_m, odometry.y_m, odometry.heading_rad))

    def _joint_states(self, t_ns: int) -> bytes:
        return messages.joint_states(t_ns, self._body.wheels_rad, self._body.odometry.wheels_radps)

    def _imu(self, t_ns: int) -> bytes:
        v, w = self._body.velocity
        beat, before = self._felt
        ahead = (v - before) / BEAT_S if beat == self._beat - IMU_BEATS else 0.0  # nobody listened: not known
        self._felt = (self._beat, v)
        turns = self._imu_noise.normal(0.0, messages.TURN_NOISE_RADPS, 3)
        pushes = self._imu_noise.normal(0.0, messages.PUSH_NOISE_MPS2, 3)
        turns[2] += w
        pushes[0] += ahead
        pushes[1] += v * w
        return messages.imu(t_ns, self._body.pose[2], turns.tolist(), pushes.tolist())

    def _image(self, t_ns: int) -> bytes:
        return messages.image(t_ns, WIDTH, HEIGHT, self._picture(t_ns))

    def _compressed(self, t_ns: int) -> bytes:
        return messages.compressed_image(t_ns, png_of(WIDTH, HEIGHT, self._picture(t_ns)))

    def _picture(self, t_ns: int) -> bytes:
        if self._seen[0] != t_ns:
            if self._camera is None:
                self._camera = RoomCamera(self._room)
            self._seen = (t_ns, self._camera.picture(self._body.pose))
        return self._seen[1]

    def _scan(self, t_ns: int) -> bytes:
        """Measure all around, as Gazebo's sensor does: what is too near or too far is an infinity (REP 117)."""
        x, y, heading = self._body.pose
        if self._body.level and self._scanner.exact:
            x += SCANNER_X_M * math.cos(heading)
            y += SCANNER_X_M * math.sin(heading)
            ranges = self._scanner.ranges_m(x, y, heading, MOST_RANGE_M)
        else:
            ranges = np.array(self._body.scan_m(ANGLES_RAD, MOST_RANGE_M), dtype=np.float32)
        noisy = ranges + self._scan_noise.normal(0.0, self._noise_m, len(ranges))
        np.maximum(noisy, LEAST_RANGE_M, out=noisy)
        np.minimum(noisy, MOST_RANGE_M, out=noisy)
        noisy[ranges >= MOST_RANGE_M] = math.inf
        noisy[ranges <= LEAST_RANGE_M] = -math.inf
        return messages.laser_scan(t_ns, noisy.astype("<f4").tobytes())
