"""Attack: more entities than allowed.

Expected: protocol
"""

import os
import struct

CHANNEL = 3


def frame(kind, body=b""):
    data = struct.pack("<IB", 1 + len(body), kind) + body
    while data:
        data = data[os.write(CHANNEL, data) :]


def text(value):
    return struct.pack("<H", len(value)) + value


def entity(identifier, what=2, t=0, node=b"/n", name=b"/turtle1/cmd_vel", kind=b"geometry_msgs/msg/Twist"):
    frame(0x10, struct.pack("<HBq", identifier, what, t) + text(node) + text(name) + text(kind)
          + struct.pack("<BBH", 1, 2, 10))


for n in range(8_200):
    entity(1000 + n)
