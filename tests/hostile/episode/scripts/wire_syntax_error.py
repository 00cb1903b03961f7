"""Attack: claim a syntax error, which costs no attempt, though the script has run.

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


print("what this prints is seen without an attempt, if the claim is believed")
frame(0x21, struct.pack("<qBBi", 0, 3, 0, 1) + text(b"SyntaxError") + text(b"invalid syntax") + struct.pack("<II", 1, 0))
os._exit(1)
