import rclpy, time
from rclpy.node import Node
from geometry_msgs.msg import Twist

class Yao(Node):
    def __init__(self):
        super().__init__('yao')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    def zhuan(self, w, miao):
        m = Twist()
        m.angular.z = w
        for i in range(int(miao * 20)):
            self.pub.publish(m)
            time.sleep(0.05)

def main():
    rclpy.init()
    y = Yao()
    time.sleep(1)
    y.zhuan(1.57, 2.0)     # 左 180
    y.zhuan(-1.57, 2.0)    # 右 180，加起来360
    y.zhuan(0.0, 0.1)

main()
