import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class BackwardMover(Node):
    def __init__(self):
        super().__init__('backward_mover')
        self.cmd_vel_pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.SPEED = -1.0
        self.DISTANCE = 2.0
        self.MOVE_TIME = self.DISTANCE / self.SPEED

    def move(self):
        msg = Twist()
        msg.linear.x = self.SPEED
        start = time.time()
        while time.time() - start < self.MOVE_TIME:
            self.cmd_vel_pub.publish(msg)
            time.sleep(0.01)
        self.cmd_vel_pub.publish(Twist())
        self.get_logger().info('后退完成')


def main():
    rclpy.init()
    node = BackwardMover()
    time.sleep(1)
    node.move()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
