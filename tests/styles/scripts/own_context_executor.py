import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Private(Node):
    def __init__(self, context):
        super().__init__('private', context=context)
        self.n = 0
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_timer(0.1, self.tick)

    def tick(self):
        self.n += 1
        msg = Twist()
        msg.linear.x = 1.0 if self.n <= 10 else 0.0
        self.pub.publish(msg)


context = Context()
rclpy.init(context=context)
node = Private(context)
executor = SingleThreadedExecutor(context=context)
executor.add_node(node)
while node.n < 12:
    executor.spin_once(timeout_sec=1.0)
executor.shutdown()
node.destroy_node()
rclpy.shutdown(context=context)
print(rclpy.ok(), context.ok())
