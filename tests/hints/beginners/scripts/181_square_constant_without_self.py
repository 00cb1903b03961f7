import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class SquareMover(Node):
    def __init__(self):
        super().__init__('square_mover')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.MOVE_TIME = 2.0
        self.TURN_TIME = 1.5708

    def publish_for(self, v, w, t):
        msg = Twist()
        msg.linear.x = v
        msg.angular.z = w
        end = time.time() + t
        while time.time() < end:
            self.pub.publish(msg)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)

    def move_square(self):
        for i in range(4):
            self.publish_for(1.0, 0.0, self.MOVE_TIME)
            self.publish_for(0.0, 1.0, TURN_TIME)


rclpy.init()
node = SquareMover()
time.sleep(1)
node.move_square()
node.destroy_node()
rclpy.shutdown()
