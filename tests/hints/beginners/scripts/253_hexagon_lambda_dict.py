import math, time, rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node('liubianxing')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)

def make(v=0.0, w=0.0):
    m = Twist(); m.linear.x = v; m.angular.z = w
    return m

actions = {
    '走': (make(v=1.0), 1.2),
    '转': (make(w=math.radians(60)), 1.0),
    '停': (make(), 0.1),
}

def do(name):
    msg, seconds = actions[name]
    t = time.monotonic()
    while time.monotonic() - t < seconds:
        pub.publish(msg)
        time.sleep(0.01)

time.sleep(1)
for c in '走停转停' * 6:
    do(c)
rclpy.shutdown()
