import time

import pybullet as p
import pybullet_data

TARGET_M = 2.0
DRIVEN = (2, 3, 5, 7)  # the wheels; 4 and 6 steer

p.connect(p.GUI)
p.setAdditionalSearchPath(pybullet_data.getDataPath())
p.setGravity(0, 0, -9.8)
car = p.loadURDF("racecar/racecar.urdf", [0, 0, 0.2])

for step in range(240 * 20):
    position, _ = p.getBasePositionAndOrientation(car)
    left = TARGET_M - position[0]
    speed = max(0.0, min(10.0, 30.0 * left)) if step > 120 else 0.0
    for wheel in DRIVEN:
        p.setJointMotorControl2(car, wheel, p.VELOCITY_CONTROL, targetVelocity=speed, force=10)
    for steering in (4, 6):
        p.setJointMotorControl2(car, steering, p.POSITION_CONTROL, targetPosition=0)
    p.stepSimulation()
    time.sleep(1 / 240)
print(p.getBasePositionAndOrientation(car)[0])
