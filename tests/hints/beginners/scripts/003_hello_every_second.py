import rclpy
from rclpy.node import Node

class Counter(Node):
    """每秒打一次招呼，并且数数"""
    def __init__(self):
        super().__init__('counter')
        self.i = 0
        self.timer = self.create_timer(1.0, self.say)

    def say(self):
        self.i += 1
        self.get_logger().info(f'第{self.i}次: 你好 ROS2')

def main():
    rclpy.init()
    try:
        rclpy.spin(Counter())
    except KeyboardInterrupt:
        print('再见')
    rclpy.try_shutdown()

main()
