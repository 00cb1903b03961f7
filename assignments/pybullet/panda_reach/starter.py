# 第 1.4 节的机械臂：让手到 (0.5, 0.2, 0.4) m，并停在那里。
import time

import pybullet as p
import pybullet_data

TARGET = [0.5, 0.2, 0.4]
HAND = 11  # panda_grasptarget：两个手指之间

p.connect(p.GUI)
p.setAdditionalSearchPath(pybullet_data.getDataPath())
p.setGravity(0, 0, -9.8)
p.loadURDF("plane.urdf")
arm = p.loadURDF("franka_panda/panda.urdf", useFixedBase=True)
for joint, angle in enumerate([0, 0.4, 0, -2.0, 0, 2.4, 0.785]):
    p.resetJointState(arm, joint, angle)  # 仿真开始之前可以摆好姿势

for step in range(240 * 4):
    # TODO: 用 p.calculateInverseKinematics(arm, HAND, TARGET) 算出各关节的角度
    # TODO: 用 p.setJointMotorControl2(arm, 关节, p.POSITION_CONTROL, targetPosition=..., force=...) 转过去
    p.stepSimulation()
    time.sleep(1 / 240)
