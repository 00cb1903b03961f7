import threading
import time
import rclpy
from geometry_msgs.msg import Twist


class Mover(threading.Thread):
    def __init__(self, pub):
        super().__init__(name='mover')
        self.pub = pub
        self.msg = Twist()
        self.lock = threading.Lock()
        self.running = True

    def run(self):
        while self.running:
            with self.lock:
                self.pub.publish(self.msg)
            time.sleep(0.02)

    def set(self, v, w):
        with self.lock:
            self.msg.linear.x = v
            self.msg.angular.z = w


rclpy.init()
node = rclpy.create_node('threaded')
mover = Mover(node.create_publisher(Twist, '/turtle1/cmd_vel', 10))
mover.start()
mover.set(1.0, 0.0)
time.sleep(2)
mover.set(0.0, 1.0)
time.sleep(1)
mover.set(1.0, 0.5)
time.sleep(1)
mover.set(0.0, 0.0)
time.sleep(0.1)
mover.running = False
mover.join()
print(mover.name, 'alive:', mover.is_alive())
rclpy.shutdown()
