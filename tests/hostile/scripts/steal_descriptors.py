"""Attack: pass descriptors through the channel, or receive some.

Expected: finished
"""

import socket

end = socket.socket(fileno=channel)
attempt("send a descriptor", socket.send_fds, end, [b"x"], [0])
attempt("receive a descriptor", socket.recv_fds, end, 1, 1)
attempt("send with ancillary data", end.sendmsg, [b"x"])
attempt("own the channel's signals", __import__("fcntl").fcntl, channel, 8, 1)
attempt("change the channel's buffers", end.setsockopt, socket.SOL_SOCKET, socket.SO_SNDBUF, 1 << 24)
end.detach()
