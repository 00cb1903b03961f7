import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.srv import TeleportAbsolute


class Teleporter(Node):
    def __init__(self):
        super().__init__('teleporter')
        self.cli = self.create_client(TeleportAbsolute, '/turtle1/teleport_absolute')
        while not self.cli.wait_for_service(timeout_sec=1.0):
            self.get_logger().info('service not available, waiting again...')
        req = TeleportAbsolute.Request()
        req.x, req.y, req.theta = 2.0, 2.0, 1.57079633
        future = self.cli.call_async(req)
        rclpy.spin_until_future_complete(self, future)
        self.get_logger().info(f'teleported: {future.result()}')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.i = 0
        self.create_timer(0.1, self.tick)

    def tick(self):
        msg = Twist()
        if self.i < 25:
            msg.linear.x = 1.0
        self.i += 1
        self.pub.publish(msg)


def main():
    rclpy.init()
    node = Teleporter()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
