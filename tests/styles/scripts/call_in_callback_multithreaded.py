import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.srv import TeleportRelative


class SyncCall(Node):
    def __init__(self):
        super().__init__('sync_call')
        group = ReentrantCallbackGroup()
        self.cli = self.create_client(TeleportRelative, '/turtle1/teleport_relative', callback_group=group)
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.n = 0
        self.timer = self.create_timer(0.1, self.step, callback_group=group)

    def step(self):
        self.n += 1
        n = self.n
        msg = Twist()
        if n == 10:
            self.cli.call(TeleportRelative.Request(linear=0.0, angular=1.5707963))
            self.get_logger().info('turned by service')
        if n < 20:
            msg.linear.x = 1.0
        self.pub.publish(msg)
        if n == 20:
            self.timer.cancel()


rclpy.init()
node = SyncCall()
executor = MultiThreadedExecutor()
executor.add_node(node)
executor.spin()
