import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class Chatty(Node):
    def __init__(self):
        super().__init__('chatty')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.n = 0
        self.create_timer(0.1, self.tick)

    def tick(self):
        self.n += 1
        log = self.get_logger()
        log.debug('never seen')
        log.info('moving', throttle_duration_sec=1.0)
        log.warn('first time only', once=True)
        log.error('not the first time', skip_first=True, once=True)
        msg = Twist()
        msg.linear.x = 1.0 if self.n <= 25 else 0.0
        self.pub.publish(msg)
        if self.n == 26:
            log.fatal('the end')
            raise SystemExit(3)


rclpy.init()
rclpy.spin(Chatty())
