"""初始化了 ROS 2，却没有创建节点。"""

import time

import rclpy

rclpy.init()
print('大家好，我启动了！')
while rclpy.ok():
    time.sleep(0.5)
