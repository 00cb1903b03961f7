"""Attack: reach the network, the host's services, and unix sockets of every kind.

Expected: finished
"""

import socket

for family in socket.AddressFamily:
    for kind in (socket.SOCK_STREAM, socket.SOCK_DGRAM, socket.SOCK_RAW, socket.SOCK_SEQPACKET):
        attempt(f"{family.name} {kind.name}", socket.socket, family, kind)
attempt("connect to itself", socket.create_connection, ("127.0.0.1", 22), 1)
attempt("look up a name", socket.getaddrinfo, "example.org", 80)
attempt("a pair of datagram sockets", socket.socketpair, socket.AF_UNIX, socket.SOCK_DGRAM)
left, right = socket.socketpair()
for address in ("/run/docker.sock", "\0abstract", "/var/run/dbus/system_bus_socket"):
    attempt(f"connect {address!r}", left.connect, address)
    attempt(f"bind {address!r}", left.bind, address)
    attempt(f"send to {address!r}", left.sendto, b"x", address)
attempt("listen", left.listen)
import asyncio
print("held: asyncio works", asyncio.run(asyncio.sleep(0, "yes")))
