import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Vector3


class Spinner(Node):
    def __init__(self):
        super().__init__('spinner')
        # 角速度是一个向量
        self.pub = self.create_publisher(Vector3, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.tick)

    def tick(self):
        angular = Vector3()
        angular.z = 1.0
        self.pub.publish(angular)


def main():
    rclpy.init()
    rclpy.spin(Spinner())


if __name__ == '__main__':
    main()
