import time
import rclpy
from geometry_msgs.msg import Twist

# 目标：走 2 米
JULI = 2.0
SUDU = 1.0

rclpy.init()
node = rclpy.create_node('zhixing')
pub = node.create_publisher(Twist, 'turtle1/cmd_vel', 10)
time.sleep(1)

qianjin = Twist()
qianjin.linear.x = SUDU
kaishi = time.time()
while time.time() - kaishi < JULI / SUDU:
    pub.publish(qianjin)
    time.sleep(0.05)

pub.publish(Twist())   # 停车
time.sleep(0.2)
node.get_logger().info('到了')
node.destroy_node()
rclpy.shutdown()
