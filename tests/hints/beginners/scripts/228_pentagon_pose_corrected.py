import math
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose

rclpy.init()
node = Node('pentagon_pose')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
pose = Pose()
got = []


def callback(p):
    global pose
    pose = p
    got.append(1)


node.create_subscription(Pose, '/turtle1/pose', callback, 1)


def send(v=0.0, w=0.0):
    m = Twist()
    m.linear.x = float(v)
    m.angular.z = float(w)
    pub.publish(m)
    rclpy.spin_once(node, timeout_sec=0.1)


while not got:
    rclpy.spin_once(node)

theta = pose.theta
for i in range(5):
    x, y = pose.x, pose.y
    d = 0.0
    while d < 1.995:
        send(v=max(0.05, min(1.0, 3 * (2.0 - d))))
        d = math.sqrt((pose.x - x) ** 2 + (pose.y - y) ** 2)
    send()
    theta += math.radians(72)
    e = 1.0
    while abs(e) > 0.004:
        e = math.remainder(theta - pose.theta, 2 * math.pi)
        send(w=1.8 * e)
    send()
send()
rclpy.shutdown()
