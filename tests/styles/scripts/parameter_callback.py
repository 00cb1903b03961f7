import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from rcl_interfaces.msg import SetParametersResult
from geometry_msgs.msg import Twist


class Tunable(Node):
    def __init__(self):
        super().__init__('tunable')
        self.declare_parameter('speed', 1.0)
        self.speed = 1.0
        self.add_on_set_parameters_callback(self.on_change)
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.n = 0
        self.create_timer(0.1, self.tick)

    def on_change(self, params):
        for p in params:
            if p.name == 'speed' and p.value < 0:
                return SetParametersResult(successful=False, reason='no reverse gear')
            self.speed = p.value
        return SetParametersResult(successful=True)

    def tick(self):
        self.n += 1
        if self.n == 11:
            self.set_parameters([Parameter('speed', Parameter.Type.DOUBLE, 2.0)])
        if self.n == 16:
            result = self.set_parameters([Parameter('speed', value=-2.0)])[0]
            self.get_logger().warning(result.reason)
        if self.n == 21:
            self.set_parameters([Parameter('speed', value=0.0)])
        msg = Twist()
        msg.linear.x = self.speed
        self.pub.publish(msg)


rclpy.init()
rclpy.spin(Tunable())
