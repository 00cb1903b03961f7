# 第 1.4 节的小车：转动轮子，直着开 2 m，再停住。
import time

import pybullet as p
import pybullet_data

p.connect(p.GUI)
p.setAdditionalSearchPath(pybullet_data.getDataPath())
p.setGravity(0, 0, -9.8)
p.loadURDF("plane.urdf")
car = p.loadURDF("racecar/racecar.urdf", [0, 0, 0.2])

for joint in range(p.getNumJoints(car)):
    print(joint, p.getJointInfo(car, joint)[1])  # 哪几个是轮子？

for step in range(240 * 10):
    # TODO: 看开了多远：p.getBasePositionAndOrientation(car)
    # TODO: 还没到 2 m 就转轮子，到了就停：p.setJointMotorControl2(car, 轮子, p.VELOCITY_CONTROL, ...)
    p.stepSimulation()
    time.sleep(1 / 240)
