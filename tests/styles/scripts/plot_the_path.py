import subprocess
import threading
import time

import matplotlib.pyplot as plt
import rclpy
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose

plt.rcParams['font.sans-serif'] = ['SimHei']
sim = subprocess.Popen(['ros2', 'run', 'turtlesim', 'turtlesim_node'])
time.sleep(2)

xs, ys = [], []
rclpy.init()
node = rclpy.create_node('plotter')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
node.create_subscription(Pose, '/turtle1/pose', lambda p: (xs.append(p.x), ys.append(p.y)), 10)
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()

msg = Twist()
msg.linear.x = 1.0
msg.angular.z = 1.0
for _ in range(30):
    pub.publish(msg)
    time.sleep(0.1)
pub.publish(Twist())

fig, ax = plt.subplots()
ax.plot(xs, ys, 'b-', label='轨迹')
ax.set_aspect('equal')
fig.savefig('path.png')
print(len(xs) > 150)
sim.terminate()
plt.show()
