import rclpy, time
from geometry_msgs.msg import Twist
rclpy.init()
node = rclpy.create_node("xiaowugui")
pub = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
m = Twist()
i = 0
while i < 4:
    m.linear.x = 2.0
    m.angular.z = 0.0
    pub.publish(m)
    time.sleep(0.5)
    m.linear.x = 0.0
    m.angular.z = 3.14159 / 2
    pub.publish(m)
    time.sleep(1 - 0.0001)
    i = i + 1
m.angular.z = 0.0
pub.publish(m)
