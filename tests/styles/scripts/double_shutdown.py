import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Twice(Node):
    def __init__(self):
        super().__init__('twice')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_timer(1.0, self.cb)

    def cb(self):
        msg = Twist()
        msg.linear.x = 1.0
        self.pub.publish(msg)
        rclpy.shutdown()


rclpy.init()
node = Twice()
rclpy.spin(node)
node.destroy_node()
rclpy.shutdown()
