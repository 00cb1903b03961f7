import rclpy
form rclpy.node import Node

class H(Node):
    def __init__(self):
        super().__init__('h')
        self.get_logger().info('h')

rclpy.init()
rclpy.spin(H())
