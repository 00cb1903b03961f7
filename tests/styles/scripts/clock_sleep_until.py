import rclpy
from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node('sleepy')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
clock = Clock(clock_type=ClockType.STEADY_TIME)
msg = Twist()
msg.linear.x = 1.0
wake = clock.now()
for i in range(10):
    pub.publish(msg)
    wake = wake + Duration(seconds=0.2)
    assert clock.sleep_until(wake)
pub.publish(Twist())
rclpy.shutdown()
