import time

import pybullet as p
import pybullet_data

p.setAdditionalSearchPath(pybullet_data.getDataPath())
p.setGravity(0, 0, -9.8)
p.loadURDF("plane.urdf")
sphere = p.loadURDF("sphere2.urdf", [0, 0, 2])

for step in range(240 * 5):
    p.stepSimulation()
    time.sleep(1 / 240)

position, orientation = p.getBasePositionAndOrientation(sphere)
print("z =", position[2])
p.disconnect()
