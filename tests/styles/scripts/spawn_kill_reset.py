import time
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from std_srvs.srv import Empty
from turtlesim.srv import Kill, Spawn


def call(node, kind, name, request):
    client = node.create_client(kind, name)
    if not client.wait_for_service(timeout_sec=2.0):
        raise RuntimeError(f'{name} is missing')
    future = client.call_async(request)
    rclpy.spin_until_future_complete(node, future, timeout_sec=2.0)
    return future.result()


def main():
    rclpy.init()
    node = Node('spawner')
    pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    go = Twist()
    go.linear.x = 1.0
    for _ in range(10):
        pub.publish(go)
        time.sleep(0.1)
    pub.publish(Twist())
    time.sleep(0.5)
    print(call(node, Spawn, '/spawn', Spawn.Request(x=1.0, y=1.0, name='friend')).name)
    print(repr(call(node, Spawn, 'spawn', Spawn.Request(x=2.0, y=1.0, name='friend')).name))
    call(node, Kill, '/kill', Kill.Request(name='friend'))
    call(node, Empty, '/reset', Empty.Request())
    for _ in range(20):
        pub.publish(go)
        time.sleep(0.1)
    pub.publish(Twist())
    node.destroy_node()
    rclpy.shutdown()


main()
