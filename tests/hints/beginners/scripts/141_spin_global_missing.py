import rclpy
from geometry_msgs.msg import Twist

count = 0
pub = None

def tick():
    count += 1
    msg = Twist()
    if count < 80:
        msg.angular.z = 1.0
    pub.publish(msg)

rclpy.init()
node = rclpy.create_node('quanju')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
node.create_timer(0.1, tick)
rclpy.spin(node)
