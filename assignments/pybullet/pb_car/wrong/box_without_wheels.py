import time

import pybullet as p
import pybullet_data

p.connect(p.GUI)
p.setAdditionalSearchPath(pybullet_data.getDataPath())
p.setGravity(0, 0, -9.8)
p.loadURDF("plane.urdf")
shape = p.createCollisionShape(p.GEOM_BOX, halfExtents=[0.5, 0.25, 0.1])
car = p.createMultiBody(baseMass=0, baseCollisionShapeIndex=shape, basePosition=[0, 0, 0.1])

for _ in range(1200):
    p.stepSimulation()
    time.sleep(1 / 240)
