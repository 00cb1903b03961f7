# 第 1.4 节的机械臂：夹住方块，提高 10 cm，保持 1 秒。
import time

import pybullet as p
import pybullet_data

HAND = 11  # panda_grasptarget：两个手指之间
FINGERS = (9, 10)  # 张开 0.04，合上 0.0

p.connect(p.GUI)
p.setAdditionalSearchPath(pybullet_data.getDataPath())
p.setGravity(0, 0, -9.8)
p.loadURDF("plane.urdf")
arm = p.loadURDF("franka_panda/panda.urdf", useFixedBase=True)
cube = p.loadURDF("cube_small.urdf", [0.5, 0, 0.025])
for joint, angle in enumerate([0, 0.4, 0, -2.0, 0, 2.4, 0.785]):
    p.resetJointState(arm, joint, angle)

down = p.getQuaternionFromEuler([3.14159, 0, 0])  # 手朝下


def move(place, opening, seconds):
    """让手到 place，手指张开 opening，用 seconds 秒。"""
    for _ in range(int(240 * seconds)):
        # TODO: 算关节角，转过去；手指也用 POSITION_CONTROL
        p.stepSimulation()
        time.sleep(1 / 240)


# TODO: 到方块上方、张开、下降、合上、提起
