import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.node import Node
from geometry_msgs.msg import Twist
from std_srvs.srv import Empty


class AsyncNode(Node):
    def __init__(self):
        super().__init__('async_node')
        self.cli = self.create_client(Empty, '/clear')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.calls = 0
        # in a group of its own, or the answer could not come while the callback awaits it
        self.timer = self.create_timer(0.4, self.on_timer, callback_group=MutuallyExclusiveCallbackGroup())

    async def on_timer(self):
        self.calls += 1
        number = self.calls
        answer = await self.cli.call_async(Empty.Request())
        self.get_logger().info(f'{number}: {type(answer).__name__}')
        msg = Twist()
        if number <= 5:
            msg.linear.x = 1.0
        elif number > 7:
            self.timer.cancel()
        self.pub.publish(msg)


rclpy.init()
rclpy.spin(AsyncNode())
