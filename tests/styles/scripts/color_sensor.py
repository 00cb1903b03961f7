import rclpy
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from geometry_msgs.msg import Twist
from turtlesim.msg import Color


class UntilPaint(Node):
    """Stops a moment after the first painted pixel was seen."""

    def __init__(self):
        super().__init__('until_paint')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Color, '/turtle1/color_sensor', self.on_color, qos_profile_sensor_data)
        self.painted = None
        self.create_timer(0.05, self.tick)

    def on_color(self, c):
        if self.painted is None and (c.r, c.g, c.b) != (255, 255, 255):
            self.painted = self.get_clock().now()
            self.get_logger().info(f'paint {c.r} {c.g} {c.b}')

    def tick(self):
        msg = Twist()
        if self.painted is None or (self.get_clock().now() - self.painted).nanoseconds < 2e9:
            msg.linear.x = 1.0
        self.pub.publish(msg)


rclpy.init()
rclpy.spin(UntilPaint())
