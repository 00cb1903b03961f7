import threading, time, rclpy
from geometry_msgs.msg import Twist

FANGXIANG = -1      # 1前进 -1后退
stop_event = threading.Event()


def sender(pub):
    m = Twist()
    m.linear.x = FANGXIANG * 0.9
    while not stop_event.wait(0.05):
        pub.publish(m)
    pub.publish(Twist())


rclpy.init()
node = rclpy.create_node('daoche')
pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
t = threading.Thread(target=sender, args=(pub,))
t.start()
time.sleep(4)
stop_event.set()
t.join()
time.sleep(0.3)
rclpy.shutdown()
