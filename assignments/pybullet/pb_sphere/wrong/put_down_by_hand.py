import time

import pybullet as p
import pybullet_data

p.connect(p.GUI)
p.setAdditionalSearchPath(pybullet_data.getDataPath())
p.setGravity(0, 0, -9.8)
p.loadURDF("plane.urdf")
sphere = p.loadURDF("sphere2.urdf", [0, 0, 2])

for step in range(1200):
    p.stepSimulation()
    p.resetBasePositionAndOrientation(sphere, [0, 0, max(0.5, 2 - step / 400)], [0, 0, 0, 1])
    time.sleep(1 / 240)
