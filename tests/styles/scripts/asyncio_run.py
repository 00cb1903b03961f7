import asyncio
import rclpy
from geometry_msgs.msg import Twist


async def drive(pub, v, w, seconds):
    msg = Twist()
    msg.linear.x = v
    msg.angular.z = w
    loop = asyncio.get_running_loop()
    end = loop.time() + seconds
    while loop.time() < end:
        pub.publish(msg)
        await asyncio.sleep(0.05)


async def blink(stop):
    n = 0
    while not stop.is_set():
        n += 1
        await asyncio.sleep(0.5)
    return n


async def main():
    rclpy.init()
    node = rclpy.create_node('asyncio_node')
    pub = node.create_publisher(Twist, '/turtle1/cmd_vel', 10)
    stop = asyncio.Event()
    blinker = asyncio.create_task(blink(stop))
    await drive(pub, 1.0, 0.0, 2.0)
    await drive(pub, 0.0, 1.0, 1.0)
    pub.publish(Twist())
    stop.set()
    print(await asyncio.wait_for(blinker, timeout=2))
    rclpy.shutdown()


asyncio.run(main())
