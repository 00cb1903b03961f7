"""Print what comes of system calls and of writing where an ordinary container refuses both (x86_64)."""

import ctypes
import errno
import json
import os

CALLS = {
    "unshare": (272, 0x10000000),
    "clone3": (435, 0, 0),
    "mount": (165, 0, 0, 0, 0, 0),
    "setns": (308, 0, 0),
    "bpf": (321, 0, 0, 0),
    "keyctl": (250, 0, 0),
    "perf_event_open": (298, 0, 0, -1, -1, 0),
}
PLACES = ("/new", "/opt/grader/new", "/etc/passwd", "/usr/bin/tini", "/proc/sys/kernel/hostname")
MASKED = ("/proc/keys", "/proc/timer_list", "/proc/kcore", "/proc/latency_stats")

libc = ctypes.CDLL(None, use_errno=True)


def answer(number: int, *arguments: int) -> str:
    return errno.errorcode[ctypes.get_errno()] if libc.syscall(number, *arguments) == -1 else "allowed"


def writing(path: str) -> str:
    try:
        open(path, "a").close()
    except OSError as error:
        return errno.errorcode[error.errno]
    return "allowed"


def content(path: str) -> str:
    with open(path) as file:
        return file.read(1)


print(
    json.dumps(
        {
            "calls": {name: answer(*call) for name, call in CALLS.items()},
            "writing": {path: writing(path) for path in PLACES},
            "masked": {path: content(path) for path in MASKED if os.path.exists(path)},
        }
    )
)
