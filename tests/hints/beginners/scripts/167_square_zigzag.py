import rclpy, time
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Zig(Node):
    def __init__(self):
        super().__init__('zig')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def act(self, x, z, t):
        msg = Twist()
        msg.linear.x = x
        msg.angular.z = z
        e = time.time() + t
        while time.time() < e:
            self.pub.publish(msg)
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)

    def square(self):
        for i in range(4):
            self.act(1.0, 0.0, 2.0)
            if i % 2 == 0:
                self.act(0.0, 1.0, 1.5708)
            else:
                self.act(0.0, -1.0, 1.5708)


if __name__ == '__main__':
    rclpy.init()
    zig = Zig()
    time.sleep(1)
    zig.square()
    zig.destroy_node()
    rclpy.shutdown()
