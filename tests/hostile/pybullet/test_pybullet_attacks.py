"""Attacks on what is scored of a PyBullet world: by hand what motors must do, and forged records of calls.

Each puts the sphere on the ground, where it cannot fall, and tries to earn the points for falling and resting.
"""

import pytest

from grader.grading.slot import Slot
from grader.jail import landlock
from tests.e2e.grading_slot import grade

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


@pytest.mark.sweep(9)
@pytest.mark.parametrize("attack", ATTACKS)
def test_what_is_done_by_hand_or_forged_earns_nothing(slot: Slot, attack: str) -> None:
    report = grade(slot, "pb_sphere", HEAD + ATTACKS[attack])  # no fault of the host: that would be raised
    assert report.score is not None
    earned = {item.id: item.earned for item in report.items}
    assert (earned["falls"], earned["rests"]) == (0, 0), report


def test_after_all_of_that_a_right_one_is_graded(slot: Slot) -> None:
    assert grade(slot, "pb_sphere", RIGHT).score == 100
