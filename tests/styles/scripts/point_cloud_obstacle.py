import numpy as np
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from geometry_msgs.msg import Twist
from sensor_msgs.msg import PointCloud2
from sensor_msgs_py import point_cloud2
from std_msgs.msg import Header


class Lidar(Node):
    """Pretends to see a wall that comes nearer by 0.1 m each tick."""

    def __init__(self):
        super().__init__('lidar')
        self.pub = self.create_publisher(PointCloud2, 'points', 10)
        self.distance = 2.5
        self.create_timer(0.1, self.scan)

    def scan(self):
        y = np.linspace(-1.0, 1.0, 21)
        points = np.stack([np.full_like(y, self.distance), y, np.zeros_like(y)], axis=1).astype(np.float32)
        self.pub.publish(point_cloud2.create_cloud_xyz32(Header(frame_id='base_link'), points))
        self.distance -= 0.1


class Driver(Node):
    def __init__(self):
        super().__init__('driver')
        self.pub = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(PointCloud2, 'points', self.on_cloud, 10)

    def on_cloud(self, cloud):
        nearest = min(float(p[0]) for p in point_cloud2.read_points(cloud, field_names=['x'], skip_nans=True))
        msg = Twist()
        msg.linear.x = 1.0 if nearest > 0.55 else 0.0
        self.pub.publish(msg)


rclpy.init()
executor = SingleThreadedExecutor()
for node in (Lidar(), Driver()):
    executor.add_node(node)
executor.spin()
