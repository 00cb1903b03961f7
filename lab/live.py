"""Twenty live cars at once, read and driven, while a class hands in: how steadily do poses come, uploads go?

Each car is driven in circles by one client and read by another; a quarter of the cars have a third one besides,
which asks for everything and never reads. Before that the class hands in alone, to compare. At the end the service
is told to stop. Exit code 1 if poses do not come
at 62.5 Hz within five percent, or if a connection outlives the stop by more than a second.
"""

from __future__ import annotations

import argparse
import json
import math
import signal
import sys
import tempfile
import threading
import time
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import httpx
import websocket

from benchmarks.classroom import ROOT, roster
from benchmarks.processes import Service, cpu_s, proportional_mib, tree

RATE_HZ = 62.5
_TOLERANCE = 0.05
_STOP_S = 1.0
_DRIVE = {"op": "publish", "topic": "/turtle1/cmd_vel", "msg": {"linear": {"x": 1.0}, "angular": {"z": 1.0}}}
_GREEDY = ("/turtle1/pose", "/odom", "/tf", "/turtle1/color_sensor", "/camera/image_raw/compressed")
_SETTLED_S = 3.0


@dataclass(slots=True)
class Reader:
    """One client that reads poses: when each came, and when its connection ended."""

    url: str
    at_s: list[float] = field(default_factory=list)
    ended_s: float = math.nan

    def run(self) -> None:
        """Read until the connection ends."""
        client = _connect(self.url)
        client.send(json.dumps({"op": "subscribe", "topic": "/turtle1/pose"}))
        try:
            while client.recv():
                self.at_s.append(time.monotonic())
        except (websocket.WebSocketException, OSError):
            pass
        self.ended_s = time.monotonic()

    def rate_hz(self, begin_s: float, end_s: float) -> float:
        """Return how many poses came in a second."""
        return sum(begin_s <= one < end_s for one in self.at_s) / (end_s - begin_s)

    def longest_s(self, begin_s: float, end_s: float) -> float:
        """Return the longest pause between two poses."""
        seen = [begin_s, *(one for one in self.at_s if begin_s <= one < end_s), end_s]
        return max(after - before for before, after in pairwise(seen))


def main() -> int:
    """Run it and print what was seen."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cars", type=int, default=20)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--per-second", type=float, default=4.0, help="uploads meanwhile; 0: none")
    options = parser.parse_args()
    students = roster(options.cars)
    with tempfile.TemporaryDirectory() as folder:
        service = Service(Path(folder), settings={"SLOTS": "2", "LIVE_CARS": str(options.cars)})
        service.start("api0")  # no context: the stop is part of what is measured
        try:
            service.await_ready(service.urls[0])
            tokens = service.enrol(students)
            return measure(service, [tokens[one] for one in students], options.seconds, options.per_second)
        finally:
            for process in service.running.values():
                process.kill()
                process.wait()


def measure(service: Service, tokens: list[str], seconds: float, per_s: float) -> int:
    """Open the cars, look at them for so many seconds, stop the service; return the exit code."""
    address, pid = service.urls[0], service.running["api0"].pid
    alone: list[float] = []
    _hand_in(address, tokens, per_s, seconds, alone)
    _tell(alone, "without a car")
    with httpx.Client(base_url=address, trust_env=False, timeout=60.0) as client:
        begun = time.monotonic()
        answers = [client.post("/api/v1/live", headers=_as(one)) for one in tokens]
        urls = [answer.raise_for_status().json()["url"] for answer in answers]
    print(f"{len(urls)} cars opened in {time.monotonic() - begun:.2f} s, one after the other")
    readers = [Reader(url) for url in urls]
    stopped = threading.Event()
    threads = [threading.Thread(target=reader.run) for reader in readers]
    threads += [threading.Thread(target=_drive, args=(url, stopped)) for url in urls]
    greedy = [_never_reading(url) for url in urls[::4]]
    for thread in threads:
        thread.start()
    time.sleep(_SETTLED_S)
    uploads: list[float] = []
    uploading = threading.Thread(target=_hand_in, args=(address, tokens, per_s, seconds, uploads))
    before, begin_s = {one: cpu_s(one) for one in tree(pid)}, time.monotonic()
    uploading.start()
    time.sleep(seconds)
    end_s, spent = time.monotonic(), {one: cpu_s(one) - before.get(one, 0.0) for one in tree(pid)}
    memory = sum(map(proportional_mib, tree(pid)))
    uploading.join()
    rates = [reader.rate_hz(begin_s, end_s) for reader in readers]
    pauses = [reader.longest_s(begin_s, end_s) for reader in readers]
    print(f"poses: {min(rates):.2f} to {max(rates):.2f} Hz; longest pause {max(pauses) * 1000:.0f} ms")
    own, together = spent[pid] / seconds, sum(spent.values()) / seconds
    print(f"service process {own:.1%} of a core; all processes {together:.1%}")
    print(f"memory {memory:.0f} MiB with {len(greedy)} clients that never read")
    _tell(uploads, "beside them")
    told_s = time.monotonic()
    service.running["api0"].send_signal(signal.SIGTERM)
    stopped.set()
    for thread in threads:
        thread.join()
    latest_s = max(reader.ended_s for reader in readers) - told_s
    print(f"all connections ended {latest_s:.2f} s after SIGTERM")
    for one in greedy:
        one.shutdown()  # type: ignore[no-untyped-call]
    steady = all(abs(rate - RATE_HZ) <= _TOLERANCE * RATE_HZ for rate in rates)
    return 0 if steady and latest_s <= _STOP_S else 1


def _as(token: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {token}"}


def _connect(url: str) -> websocket.WebSocket:
    return websocket.create_connection(url, timeout=60.0, suppress_origin=True)


def _drive(url: str, stopped: threading.Event) -> None:
    client = _connect(url)
    try:
        while not stopped.wait(0.2):
            client.send(json.dumps(_DRIVE))
    except (websocket.WebSocketException, OSError):
        pass
    client.shutdown()  # type: ignore[no-untyped-call]


def _never_reading(url: str) -> websocket.WebSocket:
    client = _connect(url)
    for topic in _GREEDY:
        client.send(json.dumps({"op": "subscribe", "topic": topic}))
    return client


def _tell(took_s: list[float], when: str) -> None:
    if took_s:
        ranked = sorted(took_s)
        p50, p99 = (ranked[min(int(len(ranked) * share), len(ranked) - 1)] for share in (0.5, 0.99))
        print(f"{len(ranked)} uploads {when}: p50 {p50 * 1000:.0f} ms, p99 {p99 * 1000:.0f} ms")


def _hand_in(address: str, tokens: list[str], per_s: float, seconds: float, took_s: list[float]) -> None:
    """Hand a lesson's script in so often, each time by the next student; note how long each upload took."""
    if not per_s:
        return
    script = (ROOT / "lesson" / "square_mover.py").read_bytes()
    begin_s = time.monotonic()
    with httpx.Client(base_url=address, trust_env=False, timeout=60.0) as client:
        for number in range(int(per_s * seconds)):
            time.sleep(max(begin_s + number / per_s - time.monotonic(), 0.0))
            sent_s = time.monotonic()
            content = script + f"\n# {number} {begin_s}\n".encode()
            client.post(
                "/api/v1/submissions",
                headers=_as(tokens[number % len(tokens)]),
                data={"assignment": "square"},
                files={"file": ("square_mover.py", content)},
            ).raise_for_status()
            took_s.append(time.monotonic() - sent_s)


if __name__ == "__main__":
    sys.exit(main())
