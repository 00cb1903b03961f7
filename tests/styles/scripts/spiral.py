import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Spiral(Node):
    def __init__(self):
        super().__init__('spiral')
        self.v = 0.5
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_timer(0.5, self.grow)

    def grow(self):
        cmd = Twist()
        cmd.linear.x = self.v
        cmd.angular.z = 1.0
        self.pub.publish(cmd)
        self.v += 0.1
        if self.v > 1.65:
            self.pub.publish(Twist())
            raise KeyboardInterrupt


rclpy.init()
spiral = Spiral()
try:
    rclpy.spin(spiral)
except KeyboardInterrupt:
    print('end of spiral')
spiral.destroy_node()
rclpy.shutdown()
