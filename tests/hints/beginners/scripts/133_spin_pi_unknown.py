import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Spinner(Node):
    def __init__(self):
        super().__init__('spinner')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.turn_time = 2 * math.pi / 1.0

    def turn(self):
        msg = Twist()
        msg.angular.z = 1.0
        t = time.time()
        while time.time() - t < self.turn_time:
            self.pub.publish(msg)
            time.sleep(0.01)
        self.pub.publish(Twist())


rclpy.init()
node = Spinner()
time.sleep(1)
node.turn()
rclpy.shutdown()
