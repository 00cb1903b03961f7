import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node('with_timeout')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
start = node.get_clock().now()
msg = Twist()
while rclpy.ok():
    seconds = (node.get_clock().now() - start).nanoseconds * 1e-9
    if seconds < 2:
        msg.linear.x, msg.angular.z = 1.0, 0.0
    elif seconds < 4:
        msg.linear.x, msg.angular.z = 0.0, -0.785
    elif seconds < 6:
        msg.linear.x, msg.angular.z = 1.0, 0.0
    else:
        break
    pub.publish(msg)
    rclpy.spin_once(node, timeout_sec=0.1)
pub.publish(Twist())
node.destroy_node()
rclpy.shutdown()
