import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
import time


class RectangleMover(Node):
    def __init__(self):
        super().__init__('rectangle_mover')
        self.cmd_vel_pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.SPEED = 1.0
        self.LENGTH = 3.0
        self.WIDTH = 2.0
        self.MOVE_TIME = self.LENGTH / self.SPEED
        self.TURN_TIME = 1.5708

    def act(self, v, w, t):
        msg = Twist()
        msg.linear.x = v
        msg.angular.z = w
        s = time.time()
        while time.time() - s < t:
            self.cmd_vel_pub.publish(msg)
            time.sleep(0.01)
        self.cmd_vel_pub.publish(Twist())
        time.sleep(0.1)

    def move_rectangle(self):
        for i in range(4):
            self.act(self.SPEED, 0.0, self.MOVE_TIME)
            self.act(0.0, 1.0, self.TURN_TIME)


def main():
    rclpy.init()
    node = RectangleMover()
    time.sleep(1)
    node.move_rectangle()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
