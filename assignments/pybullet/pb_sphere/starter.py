# 第 1.4 节的第一个例子：让一个球落到地面上。
# TODO 的地方请自己补上。
import time

import pybullet as p
import pybullet_data

p.connect(p.GUI)  # 交上来运行时没有窗口，一样能用
p.setAdditionalSearchPath(pybullet_data.getDataPath())

# TODO: 设重力 -9.8 m/s²（向下是负的 z）
# TODO: 加载地面 plane.urdf
# TODO: 在 2 m 高处加载 sphere2.urdf

# TODO: 循环 1200 次：仿真一步，再睡 1/240 秒
