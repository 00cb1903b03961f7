import rclpy
from rclpy.duration import Duration
from rclpy.time import Time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Arith(Node):
    def __init__(self):
        super().__init__('arith')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def for_duration(self, v, w, duration):
        msg = Twist()
        msg.linear.x = v
        msg.angular.z = w
        end = self.get_clock().now() + duration
        while self.get_clock().now() < end:
            self.pub.publish(msg)
            self.get_clock().sleep_for(Duration(nanoseconds=50_000_000))


rclpy.init()
n = Arith()
t0 = n.get_clock().now()
n.for_duration(1.0, 0.0, Duration(seconds=1.5))
n.for_duration(0.0, -1.0, Duration(seconds=1, nanoseconds=500_000_000))
n.pub.publish(Twist())
print((n.get_clock().now() - t0) >= Duration(seconds=3), Time(seconds=3, nanoseconds=5).seconds_nanoseconds())
rclpy.shutdown()
