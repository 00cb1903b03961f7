"""Attack: read a file of the host past its cache, over and over, so that the disk looks slow.

Expected: finished
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

O_DIRECT = {"x86_64": 0o40000, "aarch64": 0o200000}[os.uname().machine]
paths = (ctypes.__file__, os.__file__)
opened = [libc.open(path.encode(), O_DIRECT) for path in paths]
file = libc.open(paths[0].encode(), 0)
changed = libc.fcntl(file, 4, O_DIRECT)
print("BREACH" if max(*opened, changed) >= 0 else "held", opened, changed, flush=True)
leave()
