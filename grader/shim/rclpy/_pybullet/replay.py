"""Carry out recorded calls again and report what became of them: the world that is scored.

Runs in a confined process of its own, which no script has touched. Frames in: CALLS, and one FINISH. Frames out,
as docs/design.md ("Wire") has them: BODY, SAMPLE, PICTURE; REFUSED and APPLIED after each frame of calls; ENDED.
"""

from __future__ import annotations

import hashlib
import math
import os
import struct

from rclpy._pybullet import calls

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from typing import Any, NoReturn

    from rclpy._link import Link

CALLS, FINISH = 0x30, 0x31
BODY, SAMPLE, PICTURE, APPLIED, ENDED, REFUSED = 0x40, 0x41, 0x42, 0x43, 0x44, 0x45
COMPLETE, TOO_MANY_BODIES = 0, 1
"""Why a replay has ended."""

NOBODY, OBJECT, ROBOT = 0, 1, 2
"""What a body is to the assignment."""

GONE = -1
"""In the place of a body that was removed after the first step: PyBullet gives its number to the next one."""

MOST_BODIES = 64
MOST_JOINTS = 64
MOST_CONTACTS = 32
SAMPLES_PER_S = 60.0
LAST_PICTURES = 2
"""Of a world that the script disconnects from: usually its only one. A script may do so any number of times. The
episode takes no more than these, besides the pictures that it asked for and the one at the end."""

WIDTH, HEIGHT = 320, 240
ROWS = 60
"""Of a picture, in one frame."""
REFUSALS = 10_000
"""Most numbers of calls in one REFUSED frame."""

_FILES = ("loadURDF", "loadSDF", "loadMJCF", "loadTexture", "setAdditionalSearchPath")
_SHAPES = ("createCollisionShape", "createVisualShape")
_BIRTHS = ("loadURDF", "loadSDF", "loadMJCF", "createMultiBody")
_STEP_S = 1.0 / 240.0
_ANY_ROBOT = "*"
_SLACK_S = 1e-9

bullet: Any = None
"""The extension; `rclpy._pybullet.warm` puts it here."""


def run(task: dict[str, Any], link: Link, end: Callable[[int], NoReturn]) -> NoReturn:
    """Replay what comes over `link` until FINISH; `task` says what to look at."""
    replay = Replay(task, link.send_frame)
    while (body := link.receive_frame())[0] != FINISH and replay.take(body):
        pass
    replay.finish()
    end(0)


class Replay:
    """One replay.

    Attributes:
        task: ``object`` and ``robot``, files whose first body is looked at (empty: none; the object may be ``*``:
            the first that can drive); ``link`` of the robot; ``pictures``, numbers of the steps after which one is
            taken; ``data``, the folder of PyBullet's models.
    """

    def __init__(self, task: dict[str, Any], send: Callable[[bytes], None]) -> None:
        import pybullet_data

        self._task = task
        self._send = send
        self._data = os.path.realpath(pybullet_data.getDataPath())
        self._numbers = list(calls.RECORDED)
        self._count = 0
        self._world = 0  # number of the first call of the present world
        self._refused: list[int] = []
        self._steps = 0
        self._step_s = _STEP_S
        self._time_s = 0.0
        self._next_s = 0.0
        self._sampled = self._pictured = -1
        self._connected = False
        self._reason = COMPLETE
        self._roles: dict[int, int] = {}
        self._camera: tuple[Any, ...] | None = None
        self._pictures = set(task["pictures"])
        self._last_pictures = LAST_PICTURES

    def take(self, body: bytes) -> bool:
        """Carry out a frame of calls; false: the replay is over."""
        for number, args, options in calls.read(body, 9):
            if not self._call(self._numbers[number], args, options):
                self._refused.append(self._count)
            self._count += 1
            if self._reason != COMPLETE:
                return False
        self._report_refused()
        self._send(struct.pack("<BI", APPLIED, self._count))
        return True

    def _report_refused(self) -> None:
        for first in range(0, len(self._refused), REFUSALS):
            numbers = self._refused[first : first + REFUSALS]
            self._send(struct.pack(f"<BH{len(numbers)}I", REFUSED, len(numbers), *numbers))
        self._refused.clear()

    def finish(self) -> None:
        """Send the last state and the end."""
        self._report_refused()
        if self._connected:
            self._sample()
            self._picture()
        digest = state_digest(bullet) if self._connected else bytes(32)
        self._send(struct.pack("<BBII", ENDED, self._reason, self._count, self._steps) + digest)

    def _call(self, name: str, args: list[Any], options: dict[str, Any]) -> bool:
        """Carry out one call; false: PyBullet refused it, or it names a file of the host."""
        if name in (*_FILES, *_SHAPES) and not self._within_models(args, options):
            return False
        ours = self._connected and calls.client_of(name, args, options) == 0
        if name == "stepSimulation" and ours:
            return self._step(args, options)
        if name == "resetDebugVisualizerCamera":
            self._camera = tuple(args)
            return True
        if name == "disconnect" and ours:
            self._leave()
        try:
            answer = getattr(bullet, name)(*args, **options)
        except Exception:  # the script met the same one
            return False
        if name == "connect":
            if answer == 0 and not self._connected:
                self._connected = True
                self._begin_anew()
        elif name == "disconnect":
            self._connected = bool(bullet.isConnected(0))
        elif ours:
            self._after(name, args, options, answer)
        return True

    def _after(self, name: str, args: list[Any], options: dict[str, Any], answer: Any) -> None:
        if name in _BIRTHS:
            file = str(options.get("fileName", args[0] if args else "")) if name.startswith("load") else ""
            for body in answer if isinstance(answer, tuple) else (answer,):
                self._appeared(body, file)
        elif name == "removeBody":
            self._removed()
        elif name == "resetSimulation":
            self._begin_anew()
        elif name in ("setTimeStep", "setPhysicsEngineParameter"):
            self._step_s = float(_engine()["fixedTimeStep"])

    def _removed(self) -> None:
        """Forget bodies that are gone; after the first step no other one takes their roles."""
        present = _bodies(bullet)
        for role, body in list(self._roles.items()):
            if body not in present:
                if self._steps:
                    self._roles[role] = GONE
                else:
                    del self._roles[role]

    def _leave(self) -> None:
        """Send the last state of a world."""
        self._sample()
        if self._last_pictures:
            self._last_pictures -= 1
            self._picture()

    def _begin_anew(self) -> None:
        """Begin a new world."""
        self._roles.clear()
        self._world = self._count + 1
        self._time_s = self._next_s = 0.0
        self._step_s = float(_engine()["fixedTimeStep"])  # a reset keeps it
        self._steps, self._sampled, self._pictured = 0, -1, -1

    def _within_models(self, args: list[Any], options: dict[str, Any]) -> bool:
        """Return whether no argument names a file outside of PyBullet's models."""
        for value in (*args, *options.values()):
            if isinstance(value, str) and (".." in value or value.startswith(("/", "~"))):
                path = os.path.realpath(value)
                if ".." in value or not f"{path}/".startswith(f"{self._data}/"):
                    return False
        return True

    def _appeared(self, body: int, file: str) -> None:
        if bullet.getNumBodies() > MOST_BODIES:
            self._reason = TOO_MANY_BODIES
            return
        role = self._role(body, file)
        if role != NOBODY:
            self._roles[role] = body
        joints = bullet.getNumJoints(body)
        masses = [float(bullet.getDynamicsInfo(body, link)[0]) for link in range(-1, joints)]
        head = struct.pack("<BIHBH", BODY, self._count, body, role, joints)
        self._send(head + struct.pack("<2d", masses[0], sum(masses)))

    def _role(self, body: int, file: str) -> int:
        """Return what a body is: the first one of its file has a role."""
        for role, key in ((OBJECT, "object"), (ROBOT, "robot")):
            text = self._task[key]
            fits = _drives(body) if text == _ANY_ROBOT else bool(text) and f"/{file}".endswith(f"/{text}")
            if fits and role not in self._roles:
                return role
        return NOBODY

    def _step(self, args: list[Any], options: dict[str, Any]) -> bool:
        if self._steps == 0:
            self._sample()
        try:
            bullet.stepSimulation(*args, **options)
        except Exception:
            return False
        self._steps += 1
        self._time_s += self._step_s
        if self._time_s + _SLACK_S >= self._next_s:
            self._sample()
        if self._steps in self._pictures:
            self._pictures.discard(self._steps)  # a new world begins to count anew
            self._picture()
        return True

    def _sample(self) -> None:
        """Send where the object and the robot are, once for each state."""
        if self._sampled == self._steps:
            return
        self._sampled = self._steps
        self._next_s = (math.floor(self._time_s * SAMPLES_PER_S + _SLACK_S) + 1) / SAMPLES_PER_S
        here = {role: body for role, body in self._roles.items() if body in _bodies(bullet)}
        engine = _engine()
        parts = [
            struct.pack("<BqIII", SAMPLE, round(self._time_s * 1e9), self._steps, self._count, self._world)
        ]
        parts.append(struct.pack("<d", engine["fixedTimeStep"]))
        parts.append(struct.pack("<3d", *(engine[f"gravityAcceleration{axis}"] for axis in "XYZ")))
        parts.append(_object_state(here.get(OBJECT)))
        parts.append(_robot_state(here.get(ROBOT), int(self._task["link"])))
        parts.append(_contacts(here.get(OBJECT if self._task["object"] else ROBOT)))
        self._send(b"".join(parts))

    def _picture(self) -> None:
        if self._pictured == self._steps:
            return
        self._pictured = self._steps
        self._camera = self._camera or _overview()  # kept: what moves must not seem to move the ground
        pixels = picture(self._camera)
        for row in range(0, HEIGHT, ROWS):
            rows = pixels[3 * WIDTH * row : 3 * WIDTH * (row + ROWS)]
            self._send(struct.pack("<BqHHH", PICTURE, round(self._time_s * 1e9), WIDTH, HEIGHT, row) + rows)


def _engine() -> dict[str, Any]:
    """Return what the engine itself says of its step and its gravity."""
    parameters: dict[str, Any] = bullet.getPhysicsEngineParameters(physicsClientId=0)
    return parameters


def _bodies(module: Any) -> list[int]:
    return [module.getBodyUniqueId(i) for i in range(module.getNumBodies())]


def _drives(body: int) -> bool:
    """Return whether a body has two axles or more and is not fixed."""
    kinds = [bullet.getJointInfo(body, joint)[2] for joint in range(bullet.getNumJoints(body))]
    moving = kinds.count(bullet.JOINT_REVOLUTE) >= 2
    return moving and float(bullet.getDynamicsInfo(body, -1)[0]) > 0.0


def _object_state(body: int | None) -> bytes:
    if body is None:
        return b"\0"
    place, turn = bullet.getBasePositionAndOrientation(body)
    speed, spin = bullet.getBaseVelocity(body)
    power = struct.pack("<d", _power(body))
    return b"\1" + struct.pack("<13d", *place, *turn, *speed, *spin) + power + _joints(body)


def _robot_state(body: int | None, link: int) -> bytes:
    if body is None or not 0 <= link < bullet.getNumJoints(body):
        return b"\0"
    state = bullet.getLinkState(body, link)
    inertial = bullet.getDynamicsInfo(body, -1)[
        3:5
    ]  # PyBullet tells where the centre of mass is, not the frame
    base, _ = bullet.multiplyTransforms(
        *bullet.getBasePositionAndOrientation(body), *bullet.invertTransform(*inertial)
    )
    return b"\1" + struct.pack("<10d", *state[4], *state[5], *base) + _joints(body)


def _power(body: int) -> float:
    """Return what the motors of a body do, in watts: torque by speed, of all joints."""
    states = (bullet.getJointState(body, joint) for joint in range(bullet.getNumJoints(body)))
    return float(sum(velocity * torque for _, velocity, _, torque in states))


def _joints(body: int) -> bytes:
    count = min(bullet.getNumJoints(body), MOST_JOINTS)
    positions = [bullet.getJointState(body, joint)[0] for joint in range(count)]
    return struct.pack(f"<B{count}d", count, *positions)


def _contacts(body: int | None) -> bytes:
    """Return who pushes against a body: other body, link, and the normal force of all points together."""
    pushes: dict[tuple[int, int], float] = {}
    for point in () if body is None else bullet.getContactPoints(bodyA=body) or ():
        other = (int(point[2]), int(point[4]))
        pushes[other] = pushes.get(other, 0.0) + float(point[9])
    strongest = sorted(pushes.items(), key=lambda each: (-each[1], each[0]))[:MOST_CONTACTS]
    packed = b"".join(struct.pack("<Hhd", other, link, force) for (other, link), force in strongest)
    return bytes((len(strongest),)) + packed


def picture(camera: Sequence[Any]) -> bytes:
    """Return what the camera sees, three bytes a pixel."""
    distance, yaw, pitch, target = camera
    view = bullet.computeViewMatrixFromYawPitchRoll(target, distance, yaw, pitch, 0, 2)
    lens = bullet.computeProjectionMatrixFOV(60.0, WIDTH / HEIGHT, 0.02, 50.0)
    drawn = bullet.getCameraImage(
        WIDTH,
        HEIGHT,
        view,
        lens,
        lightDirection=(1.0, 1.0, 2.0),
        renderer=bullet.ER_TINY_RENDERER,
        flags=bullet.ER_NO_SEGMENTATION_MASK,
    )
    import numpy as np

    pixels = np.asarray(drawn[2], dtype=np.uint8).reshape(HEIGHT, WIDTH, 4)
    return np.ascontiguousarray(pixels[:, :, :3]).tobytes()


def _overview() -> tuple[float, float, float, tuple[float, ...]]:
    """Return a camera that sees what is not fixed to the ground, and the ground below it."""
    places = [(0.0, 0.0, 0.0)]
    for body in _bodies(bullet):
        if bullet.getDynamicsInfo(body, -1)[0] > 0.0 or bullet.getNumJoints(body):
            low, high = bullet.getAABB(body)
            places += [low, high]
    lows, highs = ([f(coordinates) for coordinates in zip(*places, strict=True)] for f in (min, max))
    lows, highs = [max(each, -20.0) for each in lows], [min(each, 20.0) for each in highs]
    size = max(0.5, *(high - low for low, high in zip(lows, highs, strict=True)))
    return 1.7 * size, 50.0, -25.0, tuple((low + high) / 2.0 for low, high in zip(lows, highs, strict=True))


def state_digest(module: Any) -> bytes:
    """Return the SHA-256 of all that PyBullet shows of the bodies: two worlds with the same one are alike."""
    digest = hashlib.sha256()
    for numbers in _state(module):
        digest.update(struct.pack(f"<{len(numbers)}d", *numbers))
    return digest.digest()


def _state(module: Any) -> Iterator[tuple[float, ...]]:
    for body in _bodies(module):
        place, turn = module.getBasePositionAndOrientation(body)
        speed, spin = module.getBaseVelocity(body)
        yield (*place, *turn, *speed, *spin)
        for joint in range(module.getNumJoints(body)):
            position, velocity, _, torque = module.getJointState(body, joint)
            yield (position, velocity, torque)
