import threading
import time
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Mover(Node):
    def __init__(self):
        super().__init__('mover')
        self.v = 0.0
        self.w = 0.0
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        # 定时器一直发布“当前速度”，主线程只改 v 和 w
        self.timer = self.create_timer(0.02, self.send)

    def send(self):
        t = Twist()
        t.linear.x = self.v
        t.angular.z = self.w
        self.pub.publish(t)

    def set(self, v, w, seconds):
        self.v = v
        self.w = w
        time.sleep(seconds)
        self.v = 0.0
        self.w = 0.0
        time.sleep(0.1)


def main():
    rclpy.init()
    mover = Mover()
    executor = SingleThreadedExecutor()
    executor.add_node(mover)
    threading.Thread(target=executor.spin, daemon=True).start()
    time.sleep(1)
    for lap in range(2):
        mover.get_logger().info(f'第 {lap + 1} 圈')
        for _ in range(4):
            mover.set(1.0, 0.0, 1.5)
            mover.set(0.0, 1.0, 1.5708)
    executor.shutdown()


if __name__ == '__main__':
    main()
