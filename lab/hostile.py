"""Hostile students: each does everything at once that could cost others something, as fast as they are let."""

from __future__ import annotations

import asyncio
import json
import random
import re
from collections import Counter
from collections.abc import Callable, Coroutine, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import count, cycle
from pathlib import Path
from typing import Any, Final
from urllib.parse import urlsplit

import httpx

from benchmarks.handing_in import ADDRESS
from benchmarks.posting import Answer, Connections, Post, prepared

ATTACKS: Final = Path(__file__).resolve().parent.parent / "tests" / "hostile"
_PAUSE_S: Final = 0.1  # who attacks here uses the service's own processors: no faster than this, each
_HELD_S: Final = 20.0
_READERS, _SLEEPERS, _STREAMS, _CROWD = 6, 5, 10, 20
_SEEN: Final = ("", "/report", "/trajectory", "/plot.png", "/plot.svg?lang=en", "/gradescope.json")
_LONG: Final = b"\n".join(b"def f%d(a): return [b for b in a if b]" % number for number in range(5_000))
LOOPS: Final = {
    "loop": b"while True: pass",
    "thread": b"import threading\nx = 0\ndef f():\n    global x\n    while True: x += 1\n"
    b"threading.Thread(target=f).start()",
    "regex": b"import re\nre.match('(a|aa)+$', 'a' * 60 + 'b')",
    "sum": b"sum(range(10**12))",
}
"""Scripts that never end."""


@dataclass(slots=True)
class Hostile:
    """One hostile student.

    Attributes:
        answers: how many requests were answered with which status. sent: addresses of accepted uploads.
    """

    student: str
    token: str
    url: str
    seed: int
    answers: Counter[str] = field(default_factory=Counter)
    sent: list[str] = field(default_factory=list)

    async def run(self) -> None:
        """Attack until cancelled."""
        chance = random.Random(self.seed)  # noqa: S311
        works: list[Callable[[Connections], Coroutine[Any, Any, None]]] = [self._hand_in(chance)] * 2
        works += (
            [self._read(chance)] * _READERS + [self._read_nothing] * _SLEEPERS + [self._follow] * _STREAMS
        )
        async with Connections() as connections, asyncio.TaskGroup() as group:
            for work in (*works, self._crowd):
                group.create_task(work(connections))

    def _hand_in(self, chance: random.Random) -> Callable[[Connections], Coroutine[Any, Any, None]]:
        scripts = cycle(chance.sample(files := list(_files()), len(files)))
        numbers = count()

        async def hand_in(connections: Connections) -> None:
            while True:
                assignment, name, source = next(scripts)
                content = source + b"\n# %s %d\n" % (self.student.encode(), next(numbers))
                form = {"assignment": assignment}
                post = prepared(self.url, ADDRESS, self._headers, form, (name, content))
                answer = await self._ask(connections, post)
                if answer is not None and answer.status == httpx.codes.ACCEPTED:
                    self.sent.append(json.loads(answer.body)["status_url"])

        return hand_in

    def _read(self, chance: random.Random) -> Callable[[Connections], Coroutine[Any, Any, None]]:
        async def read(connections: Connections) -> None:
            while True:
                address = chance.choice(self.sent or [ADDRESS + "/none"]) + chance.choice(_SEEN)
                await self._ask(connections, self._get(address))

        return read

    async def _crowd(self, connections: Connections) -> None:
        while True:
            await asyncio.gather(
                *(self._ask(connections, self._get("/api/v1/assignments")) for _ in range(_CROWD))
            )

    async def _read_nothing(self, _: Connections) -> None:
        """Ask for something long and do not read the answer."""
        while True:
            await self._hold(self._get((self.sent or [ADDRESS + "/none"])[-1] + "/report"))

    async def _follow(self, _: Connections) -> None:
        while True:
            await self._hold(self._get((self.sent or [ADDRESS + "/none"])[-1] + "/events"))

    async def _hold(self, post: Post) -> None:
        address = urlsplit(self.url)
        try:
            _, writer = await asyncio.open_connection(address.hostname, address.port)
        except OSError:
            self.answers["no connection"] += 1
            await asyncio.sleep(_PAUSE_S)
            return
        try:
            writer.write(post.content)
            await asyncio.sleep(_HELD_S)
        finally:
            writer.transport.abort()

    async def _ask(self, connections: Connections, post: Post) -> Answer | None:
        answer = None
        try:
            answer = await connections.send(post)
        except (OSError, TimeoutError):
            self.answers["no answer"] += 1
        else:
            self.answers[str(answer.status)] += 1
        await asyncio.sleep(_PAUSE_S)
        return answer

    def _get(self, path: str) -> Post:
        lines = [f"GET {path} HTTP/1.1", f"Host: {urlsplit(self.url).netloc}", "Accept-Encoding: gzip"]
        lines += [f"{name}: {value}" for name, value in self._headers.items()]
        return Post(self.url, "\r\n".join([*lines, "", ""]).encode())

    @property
    def _headers(self) -> dict[str, str]:
        return {"Authorization": f"Bearer {self.token}"}


def _files() -> Iterator[tuple[str, str, bytes]]:
    """Yield assignment, name and content of what is handed in."""
    own = sorted((ATTACKS / "abuse").glob("*.py"))
    for path in (*own, *own, *sorted((ATTACKS / "episode" / "scripts").glob("*.py"))):
        yield "square", path.name, path.read_bytes()
    yield "rosclaw", "frames_without_end.py", (ATTACKS / "abuse" / "frames_without_end.py").read_bytes()
    for number, source in enumerate((*LOOPS.values(), _LONG)):
        yield "square", f"endless{number}.py", source


def attempts_of(client: httpx.Client, addresses: Sequence[str]) -> Counter[str]:
    """Return how many uploads ended how: as an attempt, waived, or not yet."""
    found: Counter[str] = Counter()
    for address in addresses:
        document = client.get(re.sub(r"\?.*", "", address)).raise_for_status().json()
        waived = document["status"] == "infrastructure_error" or document["verdict"] == "syntax_error"
        found[
            "waiting" if document["verdict"] is None and not waived else "waived" if waived else "counted"
        ] += 1
        if waived:
            found[f"waived: {document['file_name']}"] += 1
    return found
