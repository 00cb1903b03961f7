"""Attack: drive a square by hand-made frames, then claim a syntax error, which costs no attempt.

Expected: protocol
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

t_ns = 0
for _ in range(4):
    for v_mps, w_radps, tenths in (
        (1.0, 0.0, 20),
        (0.0, 0.0, 5),
        (0.0, 1.5707963267948966, 10),
        (0.0, 0.0, 5),
    ):
        for _ in range(tenths):
            send(drive(t_ns, v_mps, w_radps))
            t_ns += 100_000_000
leave(t_ns, 3, b"SyntaxError", b"invalid syntax")
