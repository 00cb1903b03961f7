import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist

class JsonMover(Node):
    def __init__(self):
        super().__init__('json_mover')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_timer(0.1, self.send)

    def send(self):
        speed = {'x': 1.0, 'y': 0.0, 'z': 0.0}
        self.pub.publish(Twist(linear=speed))

if __name__ == '__main__':
    rclpy.init()
    rclpy.spin(JsonMover())
