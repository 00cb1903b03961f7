from abc import ABC, abstractmethod
import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Base(Node, ABC):
    def __init__(self, name):
        super().__init__(name)
        self._pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def drive(self, *, v=0.0, w=0.0, t=1.0):
        msg = Twist()
        msg.linear.x = v
        msg.angular.z = w
        for _ in range(int(t / 0.05)):
            self._pub.publish(msg)
            time.sleep(0.05)

    @abstractmethod
    def figure(self):
        ...

    def __enter__(self):
        return self

    def __exit__(self, *exc):
        self._pub.publish(Twist())
        self.destroy_node()
        rclpy.shutdown()


class LShape(Base):
    def figure(self):
        self.drive(v=1.0, t=2.0)
        self.drive(w=1.5708)
        self.drive(v=1.0, t=1.0)


rclpy.init()
with LShape('l_shape') as shape:
    shape.figure()
