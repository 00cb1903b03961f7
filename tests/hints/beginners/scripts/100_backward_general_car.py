import time
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Car(Node):

    def __init__(self, name='car'):
        super().__init__(name)
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    # -------- 基本动作 --------
    def _send(self, v, w, duration):
        m = Twist()
        m.linear.x, m.angular.z = float(v), float(w)
        end = self.get_clock().now().nanoseconds + int(duration * 1e9)
        while self.get_clock().now().nanoseconds < end:
            self.pub.publish(m)
            time.sleep(0.02)

    def forward(self, d, v=1.0):
        self._send(v, 0, d / v)

    def backward(self, d, v=1.0):
        self._send(-v, 0, d / v)

    def stop(self):
        self._send(0, 0, 0.2)


def test_sign():
    assert -1.0 < 0, '后退速度要小于零'


def main():
    test_sign()
    rclpy.init()
    car = Car()
    time.sleep(1)
    car.backward(2.5, v=1.25)
    car.stop()
    car.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
