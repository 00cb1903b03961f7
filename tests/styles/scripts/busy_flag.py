import threading
import rclpy
from geometry_msgs.msg import Twist

done = False


def finish():
    global done
    done = True


rclpy.init()
node = rclpy.create_node('busy_flag')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
msg = Twist()
msg.linear.x = 1.0
pub.publish(msg)
threading.Timer(0.8, finish).start()
while not done:
    pass
msg.linear.x = 0.0
msg.angular.z = 1.0
pub.publish(msg)
print('flag seen')
