import rclpy, math
from rclpy.node import Node
from geometry_msgs.msg import Twist
class 画正方形(Node):
    def __init__(self):
        super().__init__('square')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.state = 'FORWARD'
        self.side_count = 0
        self.elapsed = 0.0
        self.forward_duration = 2.0
        self.turn_duration = 2.0
        self.timer = self.create_timer(0.05, self.on_timer)
    def on_timer(self):
        msg = Twist()
        self.elapsed += 0.05
        if self.side_count >= 4:
            self.pub.publish(msg)
            return
        if self.state == 'FORWARD':
            msg.linear.x = 1.0
            if self.elapsed >= self.forward_duration:
                self.state = 'TURN'
                self.elapsed = 0.0
        elif self.state == 'TURN':
            msg.angular.z = math.radians(30)
            if self.elapsed >= self.turn_duration:
                self.state = 'FORWARD'
                self.elapsed = 0.0
                self.side_count += 1
        self.pub.publish(msg)
rclpy.init(); rclpy.spin(画正方形())
