import rclpy
from geometry_msgs.msg import Twist
from functools import partial

rclpy.init()
node = rclpy.create_node('lambda_turtle')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)


def send(v, w):
    t = Twist()
    t.linear.x, t.angular.z = v, w
    pub.publish(t)


timer = node.create_timer(0.1, lambda: send(1.0, 0.5))
node.create_timer(3.0, partial(timer.cancel))
rclpy.spin(node)
