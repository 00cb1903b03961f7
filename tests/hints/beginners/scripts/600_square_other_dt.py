import rclpy, math
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Plan(Node):
    def __init__(self):
        super().__init__('plan')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.steps = []
        for i in range(4):
            self.steps.append(('go', 2.0))
            self.steps.append(('turn', math.pi / 2))
        self.step = 0
        self.t = 0.0
        self.dt = 0.02
        self.create_timer(self.dt, self.loop)

    def loop(self):
        msg = Twist()
        if self.step < len(self.steps):
            kind, length = self.steps[self.step]
            if kind == 'go':
                msg.linear.x = 1.0
            elif kind == 'turn':
                msg.angular.z = 1.0
            self.t += 0.2
            if self.t >= length:
                self.t = 0.0
                self.step += 1
        self.pub.publish(msg)


rclpy.init()
rclpy.spin(Plan())
