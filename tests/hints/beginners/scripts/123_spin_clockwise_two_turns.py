import rclpy, time, math
from geometry_msgs.msg import Twist

QUAN = 2            # 转两圈
W = -1.5            # 顺时针

rclpy.init()
node = rclpy.create_node('shunshizhen')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
time.sleep(1)
m = Twist()
m.angular.z = W
t_end = time.monotonic() + QUAN * 2 * math.pi / abs(W)
while time.monotonic() < t_end:
    pub.publish(m)
    time.sleep(0.01)
m.angular.z = 0.0
pub.publish(m)
time.sleep(0.3)
rclpy.shutdown()
