import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Keyboard(Node):
    def __init__(self):
        super().__init__('keyboard')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def run(self):
        while True:
            key = input('w前进 s后退 a左转 d右转 q退出: ')
            msg = Twist()
            if key == 'w':
                msg.linear.x = 1.0
            elif key == 's':
                msg.linear.x = -1.0
            elif key == 'a':
                msg.angular.z = 1.0
            elif key == 'd':
                msg.angular.z = -1.0
            elif key == 'q':
                break
            self.pub.publish(msg)


def main():
    rclpy.init()
    k = Keyboard()
    k.run()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
