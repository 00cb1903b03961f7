import math
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Square(Node):
    def __init__(self):
        super().__init__('square')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.tick)
        self.turning = False
        self.corners = 0
        self.t0 = self.get_clock().now()

    def tick(self):
        msg = Twist()
        now = self.get_clock().now()
        elapsed = (now - self.t0).nanoseconds / 1e9
        if not self.turning:
            msg.linear.x = 1.0
            if elapsed >= 2.0:
                self.turning = True
                self.t0 = self.get_clock().now()
        else:
            msg.angular.z = math.pi / 2
            if elapsed >= 1.0:
                self.turning = False
                self.corners += 1
                self.t0 = self.get_clock().now()
        self.pub.publish(msg if self.corners < 4 else Twist())


rclpy.init()
rclpy.spin(Square())
