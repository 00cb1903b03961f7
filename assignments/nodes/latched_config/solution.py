"""A message that is kept."""

import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String


class Config(Node):
    def __init__(self):
        super().__init__('config_server')
        qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.publisher = self.create_publisher(String, 'config', qos)
        self.subscription = self.create_subscription(String, 'new_config', self.on_config, 10)
        self.send('default')

    def on_config(self, msg):
        self.send(msg.data)

    def send(self, text):
        msg = String()
        msg.data = text
        self.publisher.publish(msg)


def main():
    rclpy.init()
    node = Config()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
