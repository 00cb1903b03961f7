import time
import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node('polite')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
while pub.get_subscription_count() == 0:
    node.get_logger().info('waiting for the turtle')
    time.sleep(0.1)
while node.count_subscribers('/turtle1/cmd_vel') < 1:
    rclpy.spin_once(node, timeout_sec=0.1)
msg = Twist()
msg.linear.x = 1.0
for _ in range(20):
    pub.publish(msg)
    time.sleep(0.1)
pub.publish(Twist())
print(pub.get_subscription_count())
