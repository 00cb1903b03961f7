import rclpy
import rclpy.executors
from rclpy.node import Node
from std_msgs.msg import Int32


class Talker(Node):
    def __init__(self):
        super().__init__("heartbeat_talker")
        self.pub = self.create_publisher(Int32, "/heartbeat", 10)
        self.n = 0
        self.create_timer(0.5, self.tick)

    def tick(self):
        m = Int32()
        m.data = self.n
        self.n += 1
        self.pub.publish(m)


class Listener(Node):
    def __init__(self):
        super().__init__("heartbeat_listener")
        self.create_subscription(Int32, "/heartbeat", self.cb, 10)

    def cb(self, m):
        self.get_logger().info(f"heartbeat {m.data}")


def main():
    rclpy.init()
    ex = rclpy.executors.SingleThreadedExecutor()
    a, b = Talker(), Listener()
    ex.add_node(a)
    ex.add_node(b)
    try:
        ex.spin()
    except KeyboardInterrupt:
        pass


if __name__ == "__main__":
    main()
