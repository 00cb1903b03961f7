import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class 小乌龟(Node):
    def __init__(self, 名字='wugui'):
        super().__init__(名字)
        self.发布者 = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.次数 = 0
        self.定时器 = self.create_timer(0.1, self.走)

    def 走(self):
        消息 = Twist()
        if self.次数 < 15:
            消息.linear.x = 1.0
        elif self.次数 == 15:
            self.get_logger().info('🐢 走了1.5米,“完成” ✓')
            print('结束啦')
        self.发布者.publish(消息)
        self.次数 += 1


def 主函数():
    rclpy.init()
    rclpy.spin(小乌龟())


if __name__ == '__main__':
    主函数()
