"""Running a script on the shim alone: the fixture `run_script`.

    def test_something(run_script):
        run = run_script("import time\ntime.sleep(1)\nprint(time.time())\n", horizon_s=5)
        assert run.stdout == "1700000001.000001\n"
        assert run.exit["t_ns"] == 1_000_001_000

The script runs in a process of its own, isolated as in the jail, with nothing but the shim on its path (see
`tests.shim.forking`); the test is the episode at the other end of the channel. Everything is virtual, so times
compare exactly.
"""

import contextlib
import json
import os
import socket
import struct
import sys
import tempfile
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.shim.forking import forks

SHIM = Path(__file__).resolve().parents[2] / "grader" / "shim"
EPOCH_NS = 1_700_000_000 * 10**9
WORLD: dict[str, Any] = {
    "publishes": [["/turtle1/pose", "turtlesim/msg/Pose"]],
    "subscribes": [["/turtle1/cmd_vel", "geometry_msgs/msg/Twist"]],
    "services": [["/reset", "std_srvs/srv/Empty"]],
    "nodes": ["/turtlesim"],
}

_PACKAGES = str(Path(yaml.__file__).parents[1])
_PATH = f"""import sys
sys.path.insert(0, {str(SHIM)!r})
class Packages:
    @staticmethod
    def find_spec(name, path=None, target=None):
        from importlib.machinery import PathFinder
        return PathFinder.find_spec(name, [{_PACKAGES!r}]) if name == "yaml" else None
sys.meta_path.append(Packages)
del Packages
"""
_FULL = f"{_PATH}from rclpy._process import runner"
_BARE = (
    f"{_PATH}p = type(sys)('rclpy'); p.__path__ = [{str(SHIM)!r} + '/rclpy']; sys.modules['rclpy'] = p;"
    " from rclpy._process import runner"
)

PYTHON = os.environ.get("SHIM_PYTHON", sys.executable)
"""Interpreter of the scripts; to try the shim on another version of Python."""

Feed = Sequence[tuple[int, str, bytes]]
Services = dict[str, Callable[[bytes], bytes]]


@dataclass
class Run:
    """What a script did, as the episode sees it.

    Attributes:
        frames: every frame as ``{"kind": "PUBLISH", "t_ns": ..., ...}`` in order; a REPEAT as the PUBLISH frames
            that it stands for.
    """

    stdout: str = ""
    stderr: str = ""
    returncode: int = 0
    frames: list[dict[str, Any]] = field(default_factory=list)
    raw: list[bytes] = field(default_factory=list)

    def of(self, kind: str) -> list[dict[str, Any]]:
        """Return the frames of one kind."""
        return [frame for frame in self.frames if frame["kind"] == kind]

    @property
    def exit(self) -> dict[str, Any]:
        """Return the fields of EXIT, which must be there and be the last frame."""
        assert self.frames, self.stderr
        assert self.frames[-1]["kind"] == "EXIT", self.stderr
        return self.frames[-1]

    @property
    def notes(self) -> list[tuple[str, str]]:
        """Return the notes as (code, text), but for those that no report shows."""
        return [
            (frame["code"], frame["text"])
            for frame in self.of("NOTE")
            if frame["code"] not in ("started", "threads")
        ]

    @property
    def entities(self) -> dict[int, dict[str, Any]]:
        """Return the ENTITY frames by id."""
        return {frame["id"]: frame for frame in self.of("ENTITY")}

    def published(self, topic: str) -> list[tuple[int, bytes]]:
        """Return (t_ns, cdr) of every PUBLISH on a topic."""
        ids = {i for i, entity in self.entities.items() if entity["what"] == 2 and entity["name"] == topic}
        return [(f["t_ns"], f["cdr"]) for f in self.of("PUBLISH") if f["id"] in ids]


class Reader:
    """Cursor over the body of a frame."""

    def __init__(self, body: bytes) -> None:
        self.body = body
        self.at = 0

    def take(self, form: str) -> Any:
        values = struct.unpack_from("<" + form, self.body, self.at)
        self.at += struct.calcsize("<" + form)
        return values[0] if len(values) == 1 else values

    def text(self, length: str = "H") -> str:
        size = self.take(length)
        data = self.body[self.at : self.at + size]
        assert len(data) == size
        self.at += size
        return data.decode()

    def rest(self) -> bytes:
        data, self.at = self.body[self.at :], len(self.body)
        return data


def decode(body: bytes) -> dict[str, Any]:
    """Decode one frame from the jail, written from docs/design.md and nothing else."""
    r = Reader(body)
    kind = r.take("B")
    if kind == 0x10:
        frame = {
            "kind": "ENTITY",
            "id": r.take("H"),
            "what": r.take("B"),
            "t_ns": r.take("q"),
            "node": r.text(),
        }
        frame |= {"name": r.text(), "type": r.text(), "reliability": r.take("B"), "durability": r.take("B")}
        frame |= {"depth": r.take("H")}
    elif kind == 0x11:
        frame = {"kind": "GONE", "id": r.take("H"), "t_ns": r.take("q")}
    elif kind == 0x12:
        frame = {"kind": "PUBLISH", "id": r.take("H"), "t_ns": r.take("q"), "cdr": r.rest()}
    elif kind == 0x16:
        frame = {"kind": "REPEAT", "id": r.take("H")}
        frame |= {"times_ns": [r.take("q") for _ in range(r.take("H"))]}
    elif kind in (0x13, 0x14):
        frame = {
            "kind": "REQUEST" if kind == 0x13 else "RESPONSE",
            "id": r.take("H"),
            "sequence": r.take("I"),
        }
        frame |= {"t_ns": r.take("q"), "cdr": r.rest()}
    elif kind == 0x15:
        frame = {"kind": "ADVANCE", "t_ns": r.take("q"), "together_ns": r.take("q")}
    elif kind == 0x20:
        frame = {"kind": "NOTE", "code": r.text(), "text": r.text()}
    elif kind == 0x21:
        frame = {"kind": "EXIT", "t_ns": r.take("q"), "reason": r.take("B"), "after_interrupt": r.take("B")}
        frame |= {"code": r.take("i"), "type": r.text(), "message": r.text(), "line": r.take("I")}
        frame |= {"text": r.text("I")}
    else:
        raise AssertionError(f"unknown kind {kind:#x}")
    assert r.at == len(body), "trailing bytes"
    return frame


class Episode:
    """The fake world: records frames, answers ADVANCE from a timetable."""

    def __init__(self, end: socket.socket, feed: Feed, services: Services) -> None:
        self.end = end
        self.run = Run()
        self.due: list[tuple[int, str, bytes]] = sorted(feed, key=lambda item: item[0])
        self.responses: list[tuple[int, int, int, bytes]] = []
        self.services = services

    def serve(self) -> None:
        with self.end, self.end.makefile("rb") as stream:
            while len(head := stream.read(4)) == 4:
                (size,) = struct.unpack("<I", head)
                assert 1 <= size <= 65_536
                body = stream.read(size)
                self.run.raw.append(head + body)
                frame = decode(body)
                self.run.frames += self.repeated(frame) if frame["kind"] == "REPEAT" else [frame]
                if frame["kind"] == "ADVANCE":
                    self.end.sendall(self.answer(frame["t_ns"], frame["together_ns"]))
                elif frame["kind"] == "REQUEST":
                    self.respond(frame)

    def repeated(self, frame: dict[str, Any]) -> list[dict[str, Any]]:
        before = self.run.frames[-1]
        assert (before["kind"], before["id"]) == ("PUBLISH", frame["id"])
        assert frame["times_ns"]
        assert frame["times_ns"] == sorted(frame["times_ns"])
        return [before | {"t_ns": t_ns} for t_ns in frame["times_ns"]]

    def respond(self, frame: dict[str, Any]) -> None:
        service = self.services.get(self.run.entities[frame["id"]]["name"])
        if service is not None:
            when = frame["t_ns"] + 1_000_000
            self.responses.append((when, frame["id"], frame["sequence"], service(frame["cdr"])))

    def answer(self, target_ns: int, together_ns: int) -> bytes:
        instants = [t for t, *_ in self.due + self.responses if t <= target_ns]
        now_ns = max(min(instants, default=target_ns), together_ns)
        events = b""
        count = 0
        for t_ns, topic, cdr in [item for item in self.due if item[0] <= now_ns]:
            for i, entity in self.run.entities.items():
                if entity["what"] == 3 and entity["name"] == topic:
                    events += struct.pack("<BHIqI", 1, i, 0, t_ns, len(cdr)) + cdr
                    count += 1
        for t_ns, i, sequence, cdr in [item for item in self.responses if item[0] <= now_ns]:
            events += struct.pack("<BHIqI", 2, i, sequence, t_ns, len(cdr)) + cdr
            count += 1
        self.due = [item for item in self.due if item[0] > now_ns]
        self.responses = [item for item in self.responses if item[0] > now_ns]
        quiet_ns = min((t for t, *_ in self.due + self.responses), default=1 << 62)
        body = struct.pack("<BqqH", 0x81, now_ns, quiet_ns, count) + events
        return struct.pack("<I", len(body)) + body


def run_script_text(
    source: str | bytes,
    *,
    horizon_s: float = 60.0,
    stdin: str = "",
    args: Sequence[str] = (),
    seed: int = 0,
    file_name: str = "student.py",
    world: dict[str, Any] | None = None,
    feed: Feed = (),
    services: Services | None = None,
    bare: bool = False,
    python: str = PYTHON,
    preload: Sequence[str] = (),
    cpu_s: float = 30.0,
    output_bytes: int | None = None,
    steps: int | None = None,
    distro: str = "humble",
    runs_as: str = "python",
    warm: bool = False,
) -> Run:
    """Run `source` in a subprocess on the shim and return what it did.

    Args:
        world: START's ``world``; `WORLD` (a turtlesim) when None.
        feed: messages (t_ns, topic, cdr) that the world publishes, for ADVANCE to deliver.
        services: answers (request cdr -> response cdr) of the world's services, 1 ms after the request.
        bare: run without `rclpy/__init__.py`, for tests of the kernel alone.
        preload: modules imported before the shim takes over, as the zygote does.
        output_bytes: what the script may print.
        distro: which release of ROS 2 the script finds. runs_as: how it is started.
        warm: load ahead what most scripts need, as the zygote does.
        steps: what it may do.
        cpu_s: backstop against a script that never ends; the process is then killed by SIGXCPU.
    """
    data = source.encode() if isinstance(source, str) else source
    start = {
        "protocol": 3,
        "file_name": file_name,
        "args": list(args),
        "stdin": stdin,
        "horizon_ns": round(horizon_s * 1e9),
        "epoch_ns": EPOCH_NS,
        "seed": seed,
        "distro": distro,
        "runs_as": runs_as,
        "output_bytes": output_bytes,
        "steps": steps,
        "world": WORLD if world is None else world,
    }
    text = json.dumps(start).encode()
    body = struct.pack("<BI", 0x80, len(text)) + text + data
    ours, theirs = socket.socketpair()
    load = (_BARE if bare else _FULL) + ("; import rclpy._process.warm" if warm else "")
    episode = Episode(ours, feed, services or {})
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        with theirs:
            child = forks(python, "".join(f"import {name}; " for name in preload) + load)
            child.run(theirs.fileno(), out.fileno(), err.fileno(), cpu_s)
        reader = threading.Thread(target=episode.serve)
        reader.start()
        with contextlib.suppress(OSError):  # a child that died early tells why on stderr
            ours.sendall(struct.pack("<I", len(body)) + body)
        try:
            episode.run.returncode = child.wait()
        finally:
            reader.join()
        for stream, name in ((out, "stdout"), (err, "stderr")):
            stream.seek(0)
            setattr(episode.run, name, stream.read().decode("utf-8", "replace"))
    return episode.run


@pytest.fixture
def run_script() -> Callable[..., Run]:
    """Return `run_script_text`."""
    return run_script_text


@pytest.fixture
def run_bare() -> Callable[..., Run]:
    """Return `run_script_text` without `rclpy/__init__.py`: quicker, and independent of the node API."""

    def run(source: str | bytes, **options: Any) -> Run:
        return run_script_text(source, bare=True, **options)

    return run


assert os.path.isdir(SHIM)
