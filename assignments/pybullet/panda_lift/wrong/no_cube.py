import time

import pybullet as p
import pybullet_data

HAND = 11
FINGERS = (9, 10)

p.connect(p.GUI)
p.setAdditionalSearchPath(pybullet_data.getDataPath())
p.setGravity(0, 0, -9.8)
p.loadURDF("plane.urdf")
arm = p.loadURDF("franka_panda/panda.urdf", useFixedBase=True)
cube = arm
for joint, angle in enumerate([0, 0.4, 0, -2.0, 0, 2.4, 0.785]):
    p.resetJointState(arm, joint, angle)

down = p.getQuaternionFromEuler([3.14159, 0, 0])


def move(place, opening, seconds):
    for _ in range(int(240 * seconds)):
        joints = p.calculateInverseKinematics(arm, HAND, place, down, maxNumIterations=50)
        for joint in range(7):
            p.setJointMotorControl2(arm, joint, p.POSITION_CONTROL, targetPosition=joints[joint], force=200)
        for finger in FINGERS:
            p.setJointMotorControl2(arm, finger, p.POSITION_CONTROL, targetPosition=opening, force=40)
        p.stepSimulation()
        time.sleep(1 / 240)


move([0.5, 0, 0.25], 0.04, 1.5)
move([0.5, 0, 0.02], 0.04, 1.5)
move([0.5, 0, 0.02], 0.0, 1.0)
move([0.5, 0, 0.30], 0.0, 3.0)
print(p.getBasePositionAndOrientation(cube)[0])
