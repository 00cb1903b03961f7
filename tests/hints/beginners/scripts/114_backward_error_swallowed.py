import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class SafeBack(Node):
    def __init__(self):
        super().__init__('safe_back')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.cb)

    def cb(self):
        try:
            msg = Twist()
            msg.linear.x = -1
            self.pub.publish(msg)
        except:
            pass      # 防止报错


def main():
    rclpy.init()
    node = SafeBack()
    try:
        rclpy.spin(node)
    except:
        pass


if __name__ == '__main__':
    main()
