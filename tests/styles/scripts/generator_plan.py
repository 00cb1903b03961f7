import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


def plan():
    for v, w, ticks in ((1.0, 0.0, 30), (0.0, -1.0, 10), (1.0, 0.0, 20)):
        for _ in range(ticks):
            yield v, w
    yield 0.0, 0.0


class Player(Node):
    def __init__(self):
        super().__init__('player')
        self.plan = plan()
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_timer(1 / 20, self.tick)

    def tick(self):
        v, w = next(self.plan)
        msg = Twist()
        msg.linear.x = v
        msg.angular.z = w
        self.pub.publish(msg)


rclpy.init()
try:
    rclpy.spin(Player())
except StopIteration:
    print('plan is over')
