import numpy as np
import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Profile(Node):
    def __init__(self):
        super().__init__('profile')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def run(self):
        corners = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]])
        heading = 0.0
        for a, b in zip(corners[:-1], corners[1:]):
            delta = b - a
            want = np.arctan2(delta[1], delta[0])
            self.drive(0.0, 1.0, (want - heading) / 1.0)
            heading = want
            self.drive(1.0, 0.0, np.linalg.norm(delta))
        self.drive(0.0, 0.0, 0.1)

    def drive(self, v, w, duration):
        msg = Twist()
        msg.linear.x = np.float64(v)
        msg.angular.z = w
        end = time.time() + duration
        while time.time() < end:
            self.pub.publish(msg)
            time.sleep(0.01)


rclpy.init()
Profile().run()
rclpy.shutdown()
