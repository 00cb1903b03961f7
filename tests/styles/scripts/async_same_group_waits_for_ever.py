import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from std_srvs.srv import Empty


class Stuck(Node):
    """The default group is mutually exclusive: the answer cannot be handled while the timer awaits it."""

    def __init__(self):
        super().__init__('stuck')
        self.cli = self.create_client(Empty, '/clear')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.5, self.on_timer)
        msg = Twist()
        msg.linear.x = 1.0
        self.pub.publish(msg)

    async def on_timer(self):
        print('asking')
        await self.cli.call_async(Empty.Request())
        print('answered')
        self.pub.publish(Twist())


rclpy.init()
rclpy.spin(Stuck())
