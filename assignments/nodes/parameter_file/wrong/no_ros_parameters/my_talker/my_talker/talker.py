import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.declare_parameter('greeting', 'Hello')
        self.declare_parameter('period', 1.0)
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.timer = self.create_timer(self.get_parameter('period').value, self.on_timer)

    def on_timer(self):
        msg = String()
        msg.data = self.get_parameter('greeting').value
        self.publisher.publish(msg)


def main():
    rclpy.init()
    node = Talker()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
