"""Attacks on what is scored of a PyBullet world: by hand what motors must do, and forged records of calls.

Those of `ATTACKS` put the sphere on the ground, where it cannot fall, and try to earn the points for falling and
resting. Those of `UNDONE` do a little of an exercise, or nothing, and may earn what that is worth.
"""

import pytest

from grader.grading.slot import Slot
from grader.jail import landlock
from tests.e2e.grading_slot import grade
from tests.rows import slow_but

pytestmark = pytest.mark.skipif(landlock.abi_version() == 0, reason="this kernel has no Landlock")

HEAD = """
import os, struct, time
import pybullet as p
import pybullet_data
p.connect(p.GUI)
p.setAdditionalSearchPath(pybullet_data.getDataPath())
p.setGravity(0, 0, -9.8)
plane = p.loadURDF('plane.urdf')
sphere = p.loadURDF('sphere2.urdf', [0, 0, 0.5])
def steps(count):
    for _ in range(count):
        p.stepSimulation()
def put(height):
    p.resetBasePositionAndOrientation(sphere, [0, 0, height], [0, 0, 0, 1])
def forge(calls, t_ns=0):
    body = struct.pack('<Bq', 0x30, t_ns) + calls
    os.write(3, struct.pack('<I', len(body)) + body)
"""
STEP = r"b'\0\0\0'"
ATTACKS = {
    "lifted_by_hand": "steps(1); put(3); steps(1300)",
    "thrown_up": "steps(1); p.resetBaseVelocity(sphere, [0, 0, 9]); steps(1300)",
    "thrown_up_before_the_start": "p.resetBaseVelocity(sphere, [0, 0, 9]); steps(1300)",
    "pushed_up": "steps(1); p.applyExternalForce(sphere, -1, [0, 0, 9e3], [0, 0, 1], p.WORLD_FRAME); steps(1300)",
    "twisted": "steps(1); p.applyExternalTorque(sphere, -1, [9e3, 0, 0], p.WORLD_FRAME); steps(1300)",
    "gravity_turned": "steps(1); p.setGravity(0, 0, 9); steps(240); p.setGravity(0, 0, -9.8); steps(1300)",
    "tied_and_pulled": """
tie = p.createConstraint(plane, -1, sphere, -1, p.JOINT_FIXED, [0, 0, 0], [0, 0, 2], [0, 0, 0])
steps(240); p.removeConstraint(tie); steps(1300)""",
    "made_light": "p.changeDynamics(sphere, -1, mass=0); steps(1300)",
    "ground_let_through": "p.setCollisionFilterPair(plane, sphere, -1, -1, 0); steps(1300)",
    "ground_of_another_group": "p.setCollisionFilterGroupMask(sphere, -1, 0, 0); steps(1300)",
    "long_steps": "p.setTimeStep(1.0); put(2); steps(9)",
    "steps_of_nan": "p.setTimeStep(float('nan')); steps(1300)",
    "place_of_nan": "p.loadURDF('sphere2.urdf', [0, 0, float('nan')]); steps(1300)",
    "place_of_infinity": "put(float('inf')); steps(1300)",
    "too_many_bodies": "[p.loadURDF('cube_small.urdf', [0, 0, i]) for i in range(200)]; steps(1300)",
    "a_file_of_the_host": "p.loadURDF('../../../../../../etc/passwd')",
    "own_file_of_that_name": """
open('sphere2.urdf', 'w').write(open(pybullet_data.getDataPath() + '/cube_small.urdf').read())
p.loadURDF(os.path.abspath('sphere2.urdf'), [0, 0, 2]); steps(1300)""",
    "a_plugin": "p.loadPlugin('eglRendererPlugin')",
    "a_saved_state": "state = p.saveState(); p.restoreState(state)",
    "a_saved_world": "p.saveWorld('/tmp/world.py')",
    "another_client": """
other = p.connect(p.DIRECT)
p.loadURDF('sphere2.urdf', [0, 0, 2], physicsClientId=other)
for _ in range(1300): p.stepSimulation(physicsClientId=other)""",
    "reset_in_the_end": "steps(1300); p.resetSimulation()",
    "not_recorded": """
from rclpy._pybullet.recorder import recorder
steps(1); recorder.active = False
put(3)
recorder.active = True; steps(1300)""",
    "a_function_that_is_not_there": r"forge(b'\xff\0\0')",
    "a_call_that_is_cut_off": r"forge(b'\x06\x01\x04')",
    "nothing_called": "forge(b'')",
    "time_before_the_start": f"forge({STEP}, -5)",
    "a_list_in_itself": r"forge(b'\x1c\x01' + b'\x06\x01\x00' * 40 + b'\0\0')",
    "a_name_that_is_none": r"forge(b'\0\0\x01\x03a b\0')",
    "more_steps_than_may_be": f"[forge({STEP} * 9000) for _ in range(20)]",
    "more_bytes_than_may_be": r"[forge(b'\x1c\x01\x07\xff\x0f' + bytes(8 * 4095) + b'\0') for _ in range(600)]",
    "memory_overwritten": """
import ctypes
steps(1)
code = ctypes.c_char.in_dll(ctypes.PyDLL(p.__file__), 'PyInit_pybullet')
ctypes.memset(ctypes.addressof(code), 0, 8)""",
    "left_in_the_middle": "steps(5); os._exit(0)",
}
RIGHT = HEAD.replace("[0, 0, 0.5]", "[0, 0, 2]") + "steps(1300)"


BALL = HEAD.replace("[0, 0, 0.5]", "[0, 0, 2]")
WORLD = HEAD[: HEAD.index("sphere")] + HEAD[HEAD.index("def steps") : HEAD.index("def put")]
CAR = (
    WORLD
    + """
car, wheels = p.loadURDF('racecar/racecar.urdf', [0, 0, 0.2]), (2, 3, 5, 7)
def motors(speed, force=10):
    for wheel in wheels:
        p.setJointMotorControl2(car, wheel, p.VELOCITY_CONTROL, targetVelocity=speed, force=force)
def wall(place, size):
    return p.createMultiBody(0, p.createCollisionShape(p.GEOM_BOX, halfExtents=size), basePosition=place)
"""
)
ARM = (
    WORLD
    + """
arm, target = p.loadURDF('franka_panda/panda.urdf', useFixedBase=True), [0.5, 0.2, 0.4]
hand = p.getLinkState(arm, 11)[4]
to_target = [target[i] - hand[i] for i in range(3)]
def free():
    for joint in range(p.getNumJoints(arm)):
        p.setJointMotorControl2(arm, joint, p.VELOCITY_CONTROL, force=0)
def pose(place):
    for joint, angle in enumerate(p.calculateInverseKinematics(arm, 11, place, maxNumIterations=300)):
        p.resetJointState(arm, joint, angle)
"""
)
CUBE = ARM + "cube = p.loadURDF('cube_small.urdf', [0.5, 0, 0.025])\n"
UNDONE = [
    ("pb_sphere", "loaded_again_lower", 40, BALL + """
steps(1); p.removeBody(sphere); p.loadURDF('sphere2.urdf', [0, 0, 0.5]); steps(1300)"""),
    ("pb_sphere", "carried_down_by_loading", 40, BALL + """
for height in range(20, 5, -1):
    steps(5); p.removeBody(sphere); sphere = p.loadURDF('sphere2.urdf', [0, 0, height / 10])
steps(1300)"""),
    ("pb_sphere", "gravity_of_another_client", 40, BALL.replace("p.setGravity(0, 0, -9.8)", """
p.setGravity(0, 0, -9.8, p.connect(p.DIRECT))""") + "steps(1300)"),
    ("pb_sphere", "gravity_that_a_reset_took_away", 40, BALL.replace("plane =", """
p.resetSimulation(); plane =""") + "steps(1300)"),
    ("pb_sphere", "gravity_that_was_refused", 40, BALL.replace("p.setGravity(0, 0, -9.8)", """
try: p.setGravity(0, 0, -9.8, 0, 0)
except TypeError: pass""") + "steps(1300)"),
    ("pb_sphere", "a_refused_reset_hides_nothing", 40, HEAD + """
steps(1); put(2)
try: p.resetSimulation('all')
except TypeError: pass
steps(1300)"""),
    ("pb_sphere", "a_refused_step_length_moves_no_clock", 40, HEAD + """
p.setTimeStep(1 / 1000); steps(1)
try: p.setPhysicsEngineParameter(1 / 30, unknown=1)
except TypeError: pass
steps(50); put(2); steps(6000)"""),
    ("pb_sphere", "long_steps_kept_over_a_reset", 40, WORLD.replace("p.setGravity", """
p.setTimeStep(1.0); p.resetSimulation(); p.setGravity""") + "p.loadURDF('sphere2.urdf', [0, 0, 2]); steps(6)"),
    ("pb_sphere", "another_size", 40, WORLD + """
p.loadURDF('sphere2.urdf', [0, 0, 2], globalScaling=0.5); steps(1300)"""),
    ("pb_car", "loaded_again_further", 40, WORLD + """
car = p.loadURDF('racecar/racecar.urdf', [0, 0, 0.3], [1, 0, 0, 0])
for wheel in (2, 3, 5, 7): p.setJointMotorControl2(car, wheel, p.VELOCITY_CONTROL, targetVelocity=20, force=10)
steps(240); p.removeBody(car); p.loadURDF('racecar/racecar.urdf', [2, 0, 0.06]); steps(480)"""),
    ("pb_car", "down_a_slope", 20, CAR.replace("plane = p.loadURDF('plane.urdf')", """
plane = p.loadURDF('plane.urdf', [0, 0, 0], p.getQuaternionFromEuler([0, 0.03, 0]))""") + """
motors(0, 0); wall([2.4, 0, 0], [0.1, 2, 1]); steps(3000)"""),
    ("pb_car", "turned_on_a_jack_then_down_a_slope", 20, CAR.replace("plane = p.loadURDF('plane.urdf')", """
plane = p.loadURDF('plane.urdf', [0, 0, 0], p.getQuaternionFromEuler([0, 0.03, 0]))""") + """
jack = wall([0, 0, 0.1], [0.1, 0.05, 0.08])
p.resetBasePositionAndOrientation(car, [0, 0, 0.3], [0, 0, 0, 1])
motors(80); steps(240); motors(0, 100); steps(120); motors(0, 0)
p.removeBody(jack); steps(10); wall([2.35, 0, 0], [0.1, 2, 1]); steps(3000)"""),
    ("pb_car", "sideways_gravity", 20, CAR + """
p.setGravity(0.3, 0, -9.8); motors(0, 0); wall([2.4, 0, 0], [0.1, 2, 1]); steps(3000)"""),
    ("pb_car", "pushed_by_walls_that_appear", 20, CAR + """
motors(0, 0); steps(120)
while (x := p.getBasePositionAndOrientation(car)[0][0]) < 1.95:
    pusher = wall([x - 0.38, 0, 0.2], [0.1, 0.3, 0.2]); steps(20); p.removeBody(pusher)
motors(0); steps(600)"""),
    ("pb_car", "wheels_that_spin_from_the_start", 20, CAR + """
motors(0, 0)
for wheel in wheels: p.resetJointStateMultiDof(car, wheel, [0], [30])
steps(1200)"""),
    ("pb_car", "braked_by_damping", 50, CAR + """
motors(10); steps(400); p.changeDynamics(car, -1, linearDamping=1000.0); steps(600)"""),
    ("pb_car", "put_to_sleep", 50, CAR + """
motors(10); steps(400); p.changeDynamics(car, -1, activationState=p.ACTIVATION_STATE_SLEEP); steps(600)"""),
    ("panda_reach", "loaded_again_at_the_target", 40, ARM + """
steps(60); p.removeBody(arm); p.loadURDF('franka_panda/panda.urdf', to_target, useFixedBase=True); steps(300)"""),
    ("panda_reach", "another_arm_at_the_target", 40, ARM + """
steps(30); p.loadURDF('franka_panda/panda.urdf', to_target, useFixedBase=True); steps(300)"""),
    ("panda_reach", "put_near_the_target", 40, ARM + "pose([0.5, 0.31, 0.4]); steps(300)"),
    ("panda_reach", "a_base_elsewhere", 40, ARM + """
p.resetBasePositionAndOrientation(arm, [to_target[0], to_target[1], to_target[2] + 0.3], [0, 0, 0, 1])
for i in range(400):
    p.setJointMotorControl2(arm, 1, p.POSITION_CONTROL, min(i, 200) * 0.0025, force=200); steps(1)"""),
    ("panda_reach", "tied_to_itself", 40, ARM + """
free(); p.createConstraint(arm, -1, arm, 11, p.JOINT_POINT2POINT, [0, 0, 0], target, [0, 0, 0]); steps(1200)"""),
    ("panda_reach", "geared_to_a_place", 40, ARM + """
free(); gear = p.createConstraint(arm, 0, arm, 3, p.JOINT_GEAR, [0, 0, 1], [0, 0, 0], [0, 0, 0])
p.changeConstraint(gear, gearRatio=1, relativePositionTarget=1.0, erp=0.5, maxForce=1000); steps(1200)"""),
    ("panda_reach", "pushed_by_a_box_that_appears", 40, ARM + """
pose([0.5, 0, 0.4]); free(); box = p.createCollisionShape(p.GEOM_BOX, halfExtents=[0.5, 0.25, 0.5])
steps(10); p.createMultiBody(0, box, basePosition=[0.5, -0.05, 0.5]); steps(600)"""),
    ("panda_reach", "falls_on_a_box", 40, ARM + """
pose([0.5, 0.2, 0.75]); free(); box = p.createCollisionShape(p.GEOM_BOX, halfExtents=[0.2, 0.2, 0.15])
p.createMultiBody(0, box, basePosition=[0.5, 0.2, 0.13]); steps(2400)"""),
    ("panda_reach", "all_joints_at_once", 40, ARM + """
steps(30); angles = p.calculateInverseKinematics(arm, 11, target, maxNumIterations=300)
p.resetJointStatesMultiDof(arm, list(range(7)), [[angle] for angle in angles[:7]]); steps(300)"""),
    ("panda_lift", "loaded_again_higher", 30, CUBE + """
steps(60); p.removeBody(cube); p.loadURDF('cube_small.urdf', [0.5, 0, 0.3]); steps(600)"""),
    ("panda_lift", "tied_by_names", 30, CUBE + """
steps(60); p.createConstraint(parentBodyUniqueId=arm, parentLinkIndex=9, childBodyUniqueId=cube, childLinkIndex=-1,
    jointType=p.JOINT_FIXED, jointAxis=[0, 0, 0], parentFramePosition=[0, 0, 0], childFramePosition=[0, 0, 0])
steps(600)"""),
    ("panda_lift", "gravity_upwards_by_names", 30, CUBE + """
steps(60); p.setGravity(gravX=0, gravY=0, gravZ=2, physicsClientId=0); steps(600)"""),
]  # fmt: skip


@pytest.mark.parametrize("undone", slow_but(9, UNDONE), ids=lambda undone: undone[1])
def test_what_is_not_done_by_motors_earns_no_more_than_what_was(
    slot: Slot, undone: tuple[str, str, float, str]
) -> None:
    assignment, _, most, script = undone
    report = grade(slot, assignment, script)
    assert report.status == "graded", report
    assert report.score is not None
    assert report.score <= most, report


@pytest.mark.parametrize("attack", slow_but(9, ATTACKS))
def test_what_is_done_by_hand_or_forged_earns_nothing(slot: Slot, attack: str) -> None:
    report = grade(slot, "pb_sphere", HEAD + ATTACKS[attack])  # no fault of the host: that would be raised
    assert report.score is not None
    earned = {item.id: item.earned for item in report.items}
    assert (earned["falls"], earned["rests"]) == (0, 0), report


def test_after_all_of_that_a_right_one_is_graded(slot: Slot) -> None:
    assert grade(slot, "pb_sphere", RIGHT).score == 100
