"""在没有等待的死循环里打印。"""

import rclpy
from rclpy.node import Node

rclpy.init()
node = Node('greeter')
while True:
    print('大家好，我启动了！' * 20)
