import rclpy
import time
from rclpy.node import Node
from geometry_msgs.msg import Twist

class Triangle(Node):
    def __init__(self):
        super().__init__('triangle')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def drive(self, v, w, t):
        m = Twist()
        m.linear.x = v
        m.angular.z = w
        self.pub.publish(m)
        start = time.time()
        while time.time() - start < t:
            time.sleep(0.01)
        self.pub.publish(Twist())
        time.sleep(0.1)

def main():
    rclpy.init()
    node = Triangle()
    time.sleep(1)
    for i in range(3):
        node.drive(1.0, 0.0, 3.0)
        node.drive(0.0, 1.0, 2.094)
    node.destroy_node()
    rclpy.shutdown()

if __name__ == '__main__':
    main()
