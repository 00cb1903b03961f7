"""PyBullet scripts in the real sandbox: what is replayed is what the script saw, bit for bit, and is scored."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pybullet_data
import pytest

from grader.catalog import Catalog, set_root
from grader.contracts.assignment import Assignment, Watch
from grader.contracts.grading import Grader, GradingJob
from grader.contracts.replay import Replayed
from grader.grading.replaying import with_replay
from grader.sandbox import Sandbox, pybullet_sandbox
from grader.sim.driving import Car
from grader.sim.episode import Episode, EpisodeResult, EpisodeSpec
from grader.sim.replay import Replay
from tests.e2e.grading_slot import catalog, grade
from tests.rows import slow_but

EXERCISES = [one.id for one in Catalog(set_root("pybullet")).all()]
SEEN = """
from rclpy._pybullet.replay import state_digest
print('state', state_digest(p).hex())
"""
HEAD = """
import math, time
import pybullet as p
import pybullet_data
p.connect(p.GUI)
p.setAdditionalSearchPath(pybullet_data.getDataPath())
p.setGravity(0, 0, -9.8)
plane = p.loadURDF('plane.urdf')
"""
SCRIPTS = {
    "falling_sphere": "p.loadURDF('sphere2.urdf', [0, 0, 2])\nfor _ in range(480): p.stepSimulation()",
    "tumbling_cubes": """
for i in range(6):
    p.loadURDF('cube_small.urdf', [0.01 * i, 0.0, 0.2 + 0.2 * i], p.getQuaternionFromEuler([i, 1, 0]))
for _ in range(480): p.stepSimulation()""",
    "real_time": "p.loadURDF('sphere2.urdf', [0, 0, 2])\np.setRealTimeSimulation(1)\ntime.sleep(2)",
    "real_time_looked_at": """
sphere = p.loadURDF('sphere2.urdf', [0, 0, 2])
p.setRealTimeSimulation(1)
while p.getBasePositionAndOrientation(sphere)[0][2] > 1: time.sleep(0.01)""",
    "longer_steps": """
p.setTimeStep(1 / 100)
p.loadURDF('r2d2.urdf', [0, 0, 1])
for _ in range(200): p.stepSimulation()""",
    "engine_parameters": """
p.setPhysicsEngineParameter(numSolverIterations=20, fixedTimeStep=1 / 120, numSubSteps=2)
p.loadURDF('r2d2.urdf', [0, 0, 1])
for _ in range(200): p.stepSimulation()""",
    "wheels": """
car = p.loadURDF('racecar/racecar.urdf', [0, 0, 0.2])
for _ in range(300):
    p.setJointMotorControlArray(car, [2, 3, 5, 7], p.VELOCITY_CONTROL, targetVelocities=[5] * 4, forces=[10] * 4)
    p.stepSimulation()""",
    "torques": """
arm = p.loadURDF('kuka_iiwa/model.urdf', useFixedBase=True)
for joint in range(7): p.setJointMotorControl2(arm, joint, p.VELOCITY_CONTROL, force=0)
for step in range(300):
    for joint in range(7):
        angle, speed = p.getJointState(arm, joint)[:2]
        p.setJointMotorControl2(arm, joint, p.TORQUE_CONTROL, force=-20 * (angle - 0.5) - 2 * speed)
    p.stepSimulation()""",
    "inverse_kinematics": """
arm = p.loadURDF('franka_panda/panda.urdf', useFixedBase=True)
for step in range(120):
    place = [0.4, 0.2 * math.sin(step / 50), 0.5]
    for joint, angle in enumerate(p.calculateInverseKinematics(arm, 11, place)[:7]):
        p.setJointMotorControl2(arm, joint, p.POSITION_CONTROL, angle)
    p.stepSimulation()""",
    "inverse_dynamics": """
arm = p.loadURDF('TwoJointRobot_w_fixedJoints.urdf', useFixedBase=True)
joints = [i for i in range(p.getNumJoints(arm)) if p.getJointInfo(arm, i)[2] == p.JOINT_REVOLUTE]
for joint in joints: p.setJointMotorControl2(arm, joint, p.VELOCITY_CONTROL, force=0)
for _ in range(200):
    states = p.getJointStates(arm, joints)
    torques = p.calculateInverseDynamics(arm, [s[0] for s in states], [s[1] for s in states], [0.1] * len(joints))
    p.setJointMotorControlArray(arm, joints, p.TORQUE_CONTROL, forces=torques)
    p.stepSimulation()""",
    "links_recomputed": """
arm = p.loadURDF('franka_panda/panda.urdf', useFixedBase=True)
for step in range(80):
    p.resetJointState(arm, 1, 0.002 * step) if step < 3 else None
    p.getLinkState(arm, 11, computeLinkVelocity=1, computeForwardKinematics=True)
    p.stepSimulation()""",
    "shapes": """
box = p.createCollisionShape(p.GEOM_BOX, halfExtents=[0.1, 0.2, 0.1])
wheel = p.createCollisionShape(p.GEOM_CYLINDER, radius=0.1, height=0.05)
seen = p.createVisualShape(p.GEOM_BOX, halfExtents=[0.1, 0.2, 0.1], rgbaColor=[1, 0, 0, 1])
p.createMultiBody(1.0, box, seen, [0, 0, 1], linkMasses=[0.2], linkCollisionShapeIndices=[wheel],
    linkVisualShapeIndices=[-1], linkPositions=[[0, 0.3, 0]], linkOrientations=[[0, 0, 0, 1]],
    linkInertialFramePositions=[[0, 0, 0]], linkInertialFrameOrientations=[[0, 0, 0, 1]], linkParentIndices=[0],
    linkJointTypes=[p.JOINT_REVOLUTE], linkJointAxis=[[0, 1, 0]])
for _ in range(300): p.stepSimulation()""",
    "numpy_arguments": """
import numpy as np
sphere = p.loadURDF('sphere2.urdf', np.array([0.0, 0.0, 2.0]), np.array([0, 0, 0, 1]))
p.resetBaseVelocity(sphere, np.array([0.5, 0, 0], dtype=np.float32))
for _ in np.arange(300): p.stepSimulation()""",
    "dynamics": """
ball = p.loadURDF('sphere_small.urdf', [0, 0, 1])
p.changeDynamics(ball, -1, restitution=0.9, lateralFriction=0.4, rollingFriction=0.01, linearDamping=0.0)
p.changeDynamics(plane, -1, restitution=0.9)
for _ in range(480): p.stepSimulation()""",
    "constraint": """
one, other = (p.loadURDF('cube_small.urdf', [0.1 * i, 0, 1]) for i in range(2))
tie = p.createConstraint(one, -1, other, -1, p.JOINT_POINT2POINT, [0, 0, 0], [0.05, 0, 0], [-0.05, 0, 0])
for step in range(300):
    p.changeConstraint(tie, maxForce=50)
    p.stepSimulation()""",
    "sliders": """
speed = p.addUserDebugParameter('speed', -10, 10, 4)
car = p.loadURDF('racecar/racecar.urdf', [0, 0, 0.2])
for _ in range(200):
    p.addUserDebugLine([0, 0, 0], [1, 0, 0])
    for wheel in (2, 3, 5, 7):
        target = p.readUserDebugParameter(speed)
        p.setJointMotorControl2(car, wheel, p.VELOCITY_CONTROL, targetVelocity=target, force=10)
    p.stepSimulation()""",
    "removed": """
cube = p.loadURDF('cube_small.urdf', [0, 0, 1])
for _ in range(50): p.stepSimulation()
p.removeBody(cube)
p.loadURDF('cube_small.urdf', [0, 0, 0.5])
for _ in range(200): p.stepSimulation()""",
    "begun_anew": """
p.loadURDF('cube_small.urdf', [0, 0, 1])
for _ in range(50): p.stepSimulation()
p.resetSimulation()
p.setGravity(0, 0, -9.8)
p.loadURDF('plane.urdf'); p.loadURDF('sphere2.urdf', [0, 0, 2])
for _ in range(300): p.stepSimulation()""",
    "refused_calls": """
for wrong in (lambda: p.loadURDF('nothing.urdf'), lambda: p.setJointMotorControl2(9, 0, p.VELOCITY_CONTROL),
              lambda: p.resetBasePositionAndOrientation(77, [0, 0, 0], [0, 0, 0, 1])):
    try: wrong()
    except p.error: pass
p.loadURDF('sphere2.urdf', [0, 0, 2])
for _ in range(200): p.stepSimulation()""",
    "until_ctrl_c": """
p.loadURDF('r2d2.urdf', [0, 0, 1])
try:
    while True:
        p.stepSimulation()
        time.sleep(1 / 240)
except KeyboardInterrupt:
    pass""",
}


@pytest.fixture(scope="module")
def sandbox() -> Iterator[Sandbox]:
    with pybullet_sandbox("strict") as made:
        yield made


@pytest.fixture(scope="module")
def car() -> Iterator[Car]:
    made = Car()
    yield made
    made.close()


def ran(sandbox: Sandbox, car: Car, task: Assignment, source: str) -> tuple[EpisodeResult, str]:
    spec = EpisodeSpec(
        file_name="script.py",
        source=source.encode(),
        world=task.world,
        horizon_ns=5_000_000_000,
    )
    with sandbox.open(task.limits) as jail:
        result = Episode(spec, car).run(jail)
        return result, jail.close().stdout.text


def replayed(sandbox: Sandbox, task: Assignment, result: EpisodeResult) -> Replayed:
    told = with_replay(result, sandbox, task).replayed
    assert told is not None
    return told


def replayed_unseen(sandbox: Sandbox, task: Assignment, result: EpisodeResult) -> Replayed:
    """Replay without the pictures on the way, which take most of the time and must change nothing."""
    assert result.recorded is not None
    replay = Replay(result.recorded, task.world.watch or Watch(), pictures=0)
    with sandbox.open(task.limits) as jail:
        assert replay.run(jail)
        jail.close()
    return replay.account()


@pytest.mark.parametrize("script", slow_but(2, SCRIPTS))
def test_a_replay_ends_in_the_very_state_that_the_script_saw(sandbox: Sandbox, car: Car, script: str) -> None:
    task = catalog().get("panda_lift")
    result, printed = ran(sandbox, car, task, HEAD + SCRIPTS[script] + SEEN)
    first, again = replayed(sandbox, task, result), replayed_unseen(sandbox, task, result)
    assert len(first.pictures) > len(again.pictures)
    assert first.state == again.state != ""
    assert printed.split()[-2:] == ["state", first.state]


@pytest.mark.parametrize("name", slow_but(2, EXERCISES))
def test_a_solution_gets_full_marks_and_pictures(grader: Grader, name: str) -> None:
    assert grade(grader, name, own(name)).score == 100


def own(name: str, file: str = "solution.py") -> bytes:
    return catalog().scripts(name)[file]


@pytest.mark.parametrize("again", ["p.disconnect()", "p.resetSimulation(); p.disconnect()"])
def test_a_script_may_connect_and_disconnect_as_often_as_it_likes(grader: Grader, again: str) -> None:
    rounds = f"import pybullet as p\nfor _ in range(20): p.connect(p.DIRECT); p.stepSimulation(); {again}\n"
    report = grade(grader, "pb_sphere", rounds.encode() + own("pb_sphere"))
    assert (report.status, report.score) == ("graded", 100)


def test_a_script_may_begin_anew_as_often_as_it_likes(grader: Grader) -> None:
    rounds = (
        "import pybullet as p\np.connect(p.DIRECT)\nfor _ in range(20):\n"
        "    for _ in range(120): p.stepSimulation()\n    p.resetSimulation()\np.disconnect()\n"
    )
    report = grade(grader, "pb_sphere", rounds.encode() + own("pb_sphere"))
    assert (report.status, report.score) == ("graded", 100)


@pytest.mark.slow
def test_the_same_bytes_come_again_after_others(grader: Grader) -> None:
    first = grade(grader, "pb_sphere", own("pb_sphere"))
    assert (first.score, first.simulator[:6]) == (100, "replay")
    assert grade(grader, "spin", own("spin")).score == 100
    assert grade(grader, "pb_sphere", own("pb_sphere")).sha256() == first.sha256()


def test_the_first_example_of_the_course_text_fails_as_at_home(grader: Grader) -> None:
    report = grade(grader, "pb_sphere", own("pb_sphere", "wrong/as_printed.py"))
    error = report.runs[0].outcome.error
    assert error is not None
    assert (error.type, error.line) == ("AttributeError", 5)


@pytest.mark.slow
def test_pybullets_own_panda_runs_unmodified_until_ctrl_c(grader: Grader) -> None:
    script = Path(pybullet_data.__file__).parents[1] / "pybullet_robots" / "panda" / "loadpanda.py"
    task = replace(catalog().get("panda_reach"), horizon_s=1.0)  # a picture a step
    report = grader.grade(
        GradingJob(file_name=script.name, source=script.read_bytes(), assignment=task)
    ).report
    assert report.runs[0].outcome.status == "interrupted", report.runs[0].outcome
    assert report.items[0].earned == report.items[0].points
