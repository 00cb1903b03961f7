import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist


class TwoTimers(Node):
    def __init__(self):
        super().__init__('two_timers')
        self.speed, self.turn = 1.2, 0.0
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 1)
        self.control = self.create_timer(0.02, self.send)
        self.once = self.create_timer(2.5, self.now_turn)

    def send(self):
        msg = Twist()
        msg.linear.x = self.speed
        msg.angular.z = self.turn
        self.pub.publish(msg)

    def now_turn(self):
        # one shot
        self.once.cancel()
        self.destroy_timer(self.once)
        self.speed, self.turn = 0.0, -0.5
        self.once = self.create_timer(2.0, self.stop)

    def stop(self):
        self.destroy_timer(self.once)
        self.destroy_timer(self.control)
        self.pub.publish(Twist())


def main():
    rclpy.init()
    try:
        rclpy.spin(TwoTimers())
    except KeyboardInterrupt:
        print('stopped by user')
    finally:
        if rclpy.ok():
            rclpy.shutdown()


main()
