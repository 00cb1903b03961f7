"""Attack: get a descriptor of the grader's process from the channel, and send what is read out of turn.

Expected: finished
"""

import ctypes

CHANNEL, SOL_SOCKET, MSG_OOB = 3, 1, 1
OPTIONS = {"PEERCRED": 17, "PASSCRED": 16, "PEERSEC": 31, "PEERGROUPS": 59, "PEERPIDFD": 77}
libc = ctypes.CDLL(None, use_errno=True)
for name, option in OPTIONS.items():
    value, size = ctypes.create_string_buffer(256), ctypes.c_uint(256)
    if libc.getsockopt(CHANNEL, SOL_SOCKET, option, value, ctypes.byref(size)) == 0:
        print("BREACH:", name, value.raw[: size.value])
if libc.send(CHANNEL, b"x", 1, MSG_OOB) >= 0:
    print("BREACH: urgent data was sent")
print("held", flush=True)
