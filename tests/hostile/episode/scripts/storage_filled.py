"""Attack: fill the folder that a run may write to, keep it, execute from it, and look for a real one behind it.

Expected: finished
"""
import ctypes
import errno
import glob
import io
import mmap
import os
import posix
import sys


def refused(call, *numbers):
    try:
        result = call()
    except OSError as error:
        assert error.errno in numbers, error
    except ValueError:  # io.UnsupportedOperation, or a path that nothing can mean
        assert not numbers
    else:
        raise AssertionError(f"not refused: {result!r}")


def fill():
    with open("big.bin", "wb") as file:
        while True:
            file.write(bytes(1 << 20))


def scatter():
    for number in range(10**6):
        with open(f"/tmp/{number}", "w"):
            pass


def bury():
    for _ in range(10**6):
        os.mkdir("deeper")
        os.chdir("deeper")


assert os.listdir() == [os.path.basename(__file__)]
refused(fill, errno.ENOSPC)
assert os.path.getsize("big.bin") < 1 << 24
os.remove("big.bin")
refused(lambda: open(__file__, "rb+").truncate(1 << 40), errno.ENOSPC)
kept = open("sparse.bin", "wb+", buffering=0)
kept.seek(1 << 62)
refused(lambda: kept.write(b"x"), errno.ENOSPC)
kept.truncate(1 << 20)
os.remove("sparse.bin")
refused(lambda: mmap.mmap(kept.fileno(), 0), errno.EBADF)
kept.close()
refused(scatter, errno.ENOSPC)
for path in glob.glob("/tmp/*"):
    os.remove(path)
refused(bury, errno.ENOSPC, errno.ENAMETOOLONG)
os.chdir(os.path.expanduser("~/ros2_ws"))
refused(lambda: open("x" * 256, "w"), errno.ENAMETOOLONG)
refused(lambda: open("a/" * 3000 + "x", "w"), errno.ENAMETOOLONG)
refused(lambda: open("a\0b", "w"))

with open("evil", "wb") as file:
    file.write(b"#!/bin/sh\ntouch /tmp/evil\n")
os.chmod("evil", 0o777)
refused(lambda: os.execv("evil", ["evil"]), errno.EPERM)
refused(lambda: os.posix_spawn("evil", ["evil"], {}), errno.EPERM)
refused(lambda: ctypes.CDLL(os.path.abspath("evil")), None)
refused(lambda: os.symlink("/etc/passwd", "link"), errno.EPERM)
refused(lambda: os.link("evil", "link"), errno.EPERM)
refused(lambda: os.rename("evil", "/etc/evil"), errno.EPERM)
for path in ("evil", "/tmp/evil", "/home/evil", os.path.join(os.path.dirname(os.__file__), "evil"), "/dev/shm/evil"):
    refused(lambda: io.FileIO(path, "w"), errno.EACCES)
    refused(lambda: posix.open(path, os.O_CREAT | os.O_WRONLY), errno.EACCES)
    libc = ctypes.CDLL(None, use_errno=True)
    assert libc.open(path.encode(), os.O_CREAT | os.O_WRONLY, 0o600) == -1, path
    assert libc.mkdir(path.encode(), 0o700) == -1, path
assert libc.memfd_create(b"evil", 0) == -1
assert sys.getsizeof(open(__file__).read()) > 1000
