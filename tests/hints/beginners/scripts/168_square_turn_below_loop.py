import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
import time


class SquareMover(Node):
    def __init__(self):
        super().__init__('square_mover')
        self.cmd_vel_pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def move_straight(self, duration):
        msg = Twist()
        msg.linear.x = 1.0
        t = time.time()
        while time.time() - t < duration:
            self.cmd_vel_pub.publish(msg)
            time.sleep(0.01)
        self.stop()

    def turn(self, duration):
        msg = Twist()
        msg.angular.z = 1.0
        t = time.time()
        while time.time() - t < duration:
            self.cmd_vel_pub.publish(msg)
            time.sleep(0.01)
        self.stop()

    def stop(self):
        self.cmd_vel_pub.publish(Twist())
        time.sleep(0.1)

    def move_square(self):
        for i in range(4):
            self.get_logger().info(f'第 {i+1}/4 条边')
            self.move_straight(2.0)
        self.turn(1.5708)


def main():
    rclpy.init()
    node = SquareMover()
    time.sleep(1)
    node.move_square()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
