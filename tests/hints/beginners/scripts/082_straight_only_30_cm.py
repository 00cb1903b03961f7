import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist

DISTANCE = 0.3
SPEED = 1.0


class Short(Node):
    def __init__(self):
        super().__init__('short')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def go(self):
        m = Twist()
        m.linear.x = SPEED
        t0 = time.time()
        while time.time() - t0 < DISTANCE / SPEED:
            self.pub.publish(m)
            time.sleep(0.01)
        m.linear.x = 0.0
        self.pub.publish(m)
        time.sleep(0.1)
        self.get_logger().info('✓ 直行完成')


def main():
    rclpy.init()
    node = Short()
    time.sleep(1)
    node.go()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
