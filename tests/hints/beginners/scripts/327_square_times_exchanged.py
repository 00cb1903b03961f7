import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
import time


class SquareMover(Node):
    def __init__(self):
        super().__init__('square_mover')
        self.cmd_vel_pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.MOVE_TIME = 2.0
        self.TURN_TIME = 1.5708

    def move_straight(self, duration):
        msg = Twist()
        msg.linear.x = 1.0
        end = time.time() + duration
        while time.time() < end:
            self.cmd_vel_pub.publish(msg)
            time.sleep(0.01)
        self.stop()

    def turn(self, duration):
        msg = Twist()
        msg.angular.z = 1.0
        end = time.time() + duration
        while time.time() < end:
            self.cmd_vel_pub.publish(msg)
            time.sleep(0.01)
        self.stop()

    def stop(self):
        self.cmd_vel_pub.publish(Twist())
        time.sleep(0.1)

    def move_square(self):
        for i in range(4):
            self.move_straight(self.TURN_TIME)
            self.turn(self.MOVE_TIME)


def main():
    rclpy.init()
    node = SquareMover()
    time.sleep(1)
    node.move_square()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
