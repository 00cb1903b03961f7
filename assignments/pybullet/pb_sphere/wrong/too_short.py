import time

import pybullet as p
import pybullet_data

p.connect(p.GUI)
p.setAdditionalSearchPath(pybullet_data.getDataPath())
p.setGravity(0, 0, -9.8)
p.loadURDF("plane.urdf")
p.loadURDF("sphere2.urdf", [0, 0, 2])

for _ in range(240):
    p.stepSimulation()
    time.sleep(1 / 240)
