import time

import pybullet as p
import pybullet_data

TARGET = [0.5, 0.2, 0.4]
HAND = 6  # between the fingers

p.connect(p.GUI)
p.setAdditionalSearchPath(pybullet_data.getDataPath())
p.setGravity(0, 0, -9.8)
p.loadURDF("plane.urdf")
arm = p.loadURDF("franka_panda/panda.urdf", useFixedBase=True)
for joint, angle in enumerate([0, 0.4, 0, -2.0, 0, 2.4, 0.785]):
    p.resetJointState(arm, joint, angle)  # a start that is not stretched out

down = p.getQuaternionFromEuler([3.14159, 0, 0])
for step in range(240 * 4):
    joints = p.calculateInverseKinematics(arm, HAND, TARGET, down, maxNumIterations=50)
    for joint in range(7):
        p.setJointMotorControl2(arm, joint, p.POSITION_CONTROL, targetPosition=joints[joint], force=200)
    p.stepSimulation()
    time.sleep(1 / 240)
print(p.getLinkState(arm, HAND)[4])
