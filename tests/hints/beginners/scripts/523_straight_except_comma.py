import rclpy, time
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node('n')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
m = Twist()
m.linear.x = 0.5
try:
    while rclpy.ok():
        pub.publish(m)
        time.sleep(0.1)
except KeyboardInterrupt, e:
    pass
