# 函数写在前面，import写在中间也行？
def main():
    rclpy.init()
    xiaowugui = Xiaowugui()
    xiaowugui.get_logger().info("hello hello hello")
    rclpy.spin(xiaowugui)

import rclpy
from rclpy.node import Node as JieDian

class Xiaowugui(JieDian):
    def __init__(self, mingzi="xiaowugui"):
        JieDian.__init__(self, mingzi)

main()
