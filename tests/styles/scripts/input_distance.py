import time
import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node('asker')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
distance = float(input('距离? '))
speed = float(input('速度? '))
msg = Twist()
msg.linear.x = speed
end = time.time() + distance / speed
while time.time() < end:
    pub.publish(msg)
    time.sleep(0.02)
msg.linear.x = 0.0
pub.publish(msg)
print(f'走了 {distance} 米')
