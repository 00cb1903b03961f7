import rclpy
import time
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose

x = 0.0
y = 0.0
yaw = 0.0


def poseCallback(pose_message):
    global x, y, yaw
    x = pose_message.x
    y = pose_message.y
    yaw = pose_message.theta


def move(node, speed, distance):
    pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    msg = Twist()
    msg.linear.x = speed
    rclpy.spin_once(node)
    x0 = x
    while True:
        pub.publish(msg)
        rclpy.spin_once(node)
        if abs(x - x0) >= distance:
            break
    msg.linear.x = 0.0
    pub.publish(msg)


rclpy.init()
node = rclpy.create_node('turtlesim_motion_pose')
node.create_subscription(Pose, '/turtle1/pose', poseCallback, 10)
time.sleep(2)
move(node, 2.0, 3.0)
print('moved')
