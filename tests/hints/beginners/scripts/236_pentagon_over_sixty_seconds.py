import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Pentagon(Node):
    def __init__(self):
        super().__init__('pentagon')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.speed = 0.2       # 安全第一
        self.turn_speed = 0.25
        self.side = 2.0

    def move(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        e = time.time() + t
        while time.time() < e:
            self.pub.publish(m)
            time.sleep(0.02)
        self.pub.publish(Twist())
        time.sleep(0.1)

    def draw(self):
        for i in range(5):
            self.move(self.speed, 0.0, self.side / self.speed)
            self.move(0.0, self.turn_speed, 1.2566 / self.turn_speed)


def main():
    rclpy.init()
    p = Pentagon()
    time.sleep(1)
    p.draw()
    p.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
