import rclpy
from geometry_msgs.msg import Twist
from turtlesim.srv import SetPen

rclpy.init()
node = rclpy.create_node('impatient')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
msg = Twist()
msg.linear.x = 1.0
pub.publish(msg)
client = node.create_client(SetPen, '/turtle1/set_pen')
future = client.call_async(SetPen.Request(off=1))
print(future.result())
while not future.done():
    pass  # nobody spins: the answer never comes in
print('never')
