import asyncio
import rclpy
from geometry_msgs.msg import Twist

async def drive(pub, v, w, t):
    m = Twist()
    m.linear.x = v
    m.angular.z = w
    n = int(t / 0.05)
    for _ in range(n):
        pub.publish(m)
        asyncio.sleep(0.05)
    pub.publish(Twist())
    await asyncio.sleep(0.2)

async def main():
    rclpy.init()
    node = rclpy.create_node('a')
    pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    await asyncio.sleep(1)
    for i in range(4):
        await drive(pub, 1.0, 0.0, 2.0)
        await drive(pub, 0.0, 1.0, 1.5708)

asyncio.run(main())
