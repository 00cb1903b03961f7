import rclpy
from rclpy.node import Node
from rclpy.qos import QoSProfile, QoSReliabilityPolicy, QoSHistoryPolicy
from geometry_msgs.msg import Twist


class QosMover(Node):
    def __init__(self):
        super().__init__('qos_mover')
        qos = QoSProfile(
            reliability=QoSReliabilityPolicy.BEST_EFFORT,
            history=QoSHistoryPolicy.KEEP_LAST,
            depth=1,
        )
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', qos)
        self.create_timer(0.1, self.tick)

    def tick(self):
        msg = Twist()
        msg.linear.x = 1.0
        self.pub.publish(msg)


def main():
    rclpy.init()
    rclpy.spin(QosMover())


if __name__ == '__main__':
    main()
