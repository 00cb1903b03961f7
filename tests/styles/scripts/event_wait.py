import threading
import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node('event_wait')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
stop_event = threading.Event()
half_way = threading.Event()


def drive():
    count = 0
    msg = Twist()
    msg.linear.x = 0.5
    while not stop_event.wait(timeout=0.1):
        pub.publish(msg)
        count += 1
        if count == 10:
            half_way.set()
    pub.publish(Twist())
    node.get_logger().info(f'{count} messages')


thread = threading.Thread(target=drive)
thread.start()
half_way.wait()
print('half way')
stop_event.wait(1.05)
stop_event.set()
thread.join()
rclpy.shutdown()
