import rclpy
import time
import math
import random
from rclpy.node import Node
from geometry_msgs.msg import Twist

print("程序开始")

class A(Node):
    def __init__(self):
        super().__init__('a')
        print("init 进来了")
        self.get_logger().info("hello world")
        print("init 完了")

rclpy.init()
a = A()
print("开始 spin")
rclpy.spin(a)
print("结束")
