"""发布者用了“尽力而为”的 QoS，小乌龟收不到。"""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data


class Forward(Node):
    def __init__(self):
        super().__init__('forward')
        self.publisher = self.create_publisher(Twist, '/turtle1/cmd_vel', qos_profile_sensor_data)
        self.timer = self.create_timer(0.1, self.tick)

    def tick(self):
        msg = Twist()
        msg.linear.x = 1.0
        self.publisher.publish(msg)


def main():
    rclpy.init()
    node = Forward()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
