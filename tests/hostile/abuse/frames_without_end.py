"""Attack: have the grader work on frames that cost the script nothing.

Expected: cpu_limit or protocol or stalled
"""

import ctypes
import os
import struct

CHANNEL = 3
libc = ctypes.CDLL(None, use_errno=True)


def frame(kind, body=b""):
    return struct.pack("<IB", 1 + len(body), kind) + body


def text(value):
    return struct.pack("<H", len(value)) + value


def entity(identifier, what, name=b"", kind=b""):
    body = struct.pack("<HBq", identifier, what, 0) + text(b"/n") + text(name) + text(kind)
    return frame(0x10, body + struct.pack("<BBH", 1, 2, 10))


def drive(t_ns, v_mps=0.0, w_radps=0.0):
    twist = b"\x00\x01\x00\x00" + struct.pack("<6d", v_mps, 0, 0, 0, 0, w_radps)
    return frame(0x12, struct.pack("<Hq", 2, t_ns) + twist)


def leave(t_ns=0, reason=0, kind=b"", message=b"", traceback=b""):
    told = struct.pack("<qBBi", t_ns, reason, 0, reason) + text(kind) + text(message)
    send(frame(0x21, told + struct.pack("<II", 0, len(traceback)) + traceback))
    os._exit(reason)


def send(data):
    while data:
        data = data[os.write(CHANNEL, data) :]


send(entity(1, 1) + entity(2, 2, b"/turtle1/cmd_vel", b"geometry_msgs/msg/Twist"))

for number in range(4, 510):  # each is asked about where an assignment calls the script's services
    send(entity(number, 4, b"/s%d" % number, b"example_interfaces/srv/AddTwoInts"))
batch = frame(0x15, struct.pack("<qq", 0, 0)) * 500
answers = ctypes.create_string_buffer(1 << 16)
while True:
    send(batch)
    read = 0
    while read < 500 * 23:
        read += max(libc.recv(CHANNEL, answers, len(answers), 0), 1)
