import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

class Spinner(Node):
    def __init__(self):
        super().__init__('spinner')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.tick)

    def tick(self):
        msg = Twist()
        msg.angle.z = 1.57
        self.publisher.publish(msg)

rclpy.init()
node = Spinner()
rclpy.spin(node)
