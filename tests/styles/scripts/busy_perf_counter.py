from time import perf_counter, perf_counter_ns
import rclpy
from geometry_msgs.msg import Twist


def wait(seconds):
    start = perf_counter()
    while perf_counter() - start < seconds:
        pass


rclpy.init()
node = rclpy.create_node('busy_wait')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
forward, turn, stop = Twist(), Twist(), Twist()
forward.linear.x = 1.0
turn.angular.z = 1.0
begin = perf_counter_ns()
for _ in range(3):
    pub.publish(forward)
    wait(0.8)
    pub.publish(turn)
    wait(0.5)
pub.publish(stop)
print((perf_counter_ns() - begin) // 10**8)
rclpy.shutdown()
