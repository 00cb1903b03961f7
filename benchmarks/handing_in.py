"""Handing in: sends a plan of uploads at given instants, and keeps what was answered and how long it took."""

from __future__ import annotations

import asyncio
import json
import math
import random
import time
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import cycle

import httpx
from prometheus_client.parser import text_string_to_metric_families

from benchmarks.classroom import Upload
from benchmarks.posting import Answer, Connections, Post, prepared

ADDRESS = "/api/v1/submissions"
_ACCEPTED = 202
_SERVER_ERROR = 500
_AGAIN_S = 0.2
_TRIES = 300
_STEEPNESS = 5.0


@dataclass(frozen=True, slots=True)
class Sent:
    """One upload and its answer. `code` is 202, or the code of the problem; `order` counts answers."""

    upload: Upload
    code: str
    took_s: float
    order: int
    location: str = ""
    repeated: bool = False

    @property
    def accepted(self) -> bool:
        """Whether the service promised to grade it."""
        return self.code == str(_ACCEPTED)


@dataclass(slots=True)
class HandingIn:
    """Sends uploads; each student waits for the answer to one before the next.

    Attributes:
        urls: API processes, used in turn.
        tokens: of each student.
        insist: whether to send again, under an idempotency key, what got no answer or a server's failure.
        sent: what was answered so far.
    """

    urls: Sequence[str]
    tokens: Mapping[str, str]
    insist: bool = False
    sent: list[Sent] = field(default_factory=list)

    async def run(self, uploads: Sequence[Upload], at_s: Sequence[float]) -> None:
        """Send `uploads`, each at its second after the start or as soon after as can be."""
        one_at_a_time: dict[str, asyncio.Lock] = defaultdict(asyncio.Lock)
        posts = [self._post(upload, url) for upload, url in zip(uploads, cycle(self.urls), strict=False)]
        begun, tasks = time.monotonic(), []
        async with Connections() as connections:
            for upload, post, due_s in zip(uploads, posts, at_s, strict=True):
                await asyncio.sleep(max(0.0, begun + due_s - time.monotonic()))
                sending = self._send(connections, post, upload, one_at_a_time[upload.student])
                tasks.append(asyncio.create_task(sending))
            await asyncio.gather(*tasks)

    async def _send(self, connections: Connections, post: Post, upload: Upload, lock: asyncio.Lock) -> None:
        async with lock:
            started = time.perf_counter()
            answer = await self._answer(connections, post)
            took_s = time.perf_counter() - started
        document = json.loads(answer.body)
        accepted = answer.status == _ACCEPTED
        self.sent.append(
            Sent(
                upload,
                str(_ACCEPTED) if accepted else document["code"],
                took_s,
                len(self.sent),
                post.url + document["status_url"] if accepted else "",
                accepted and document["repeated"],
            )
        )

    async def _answer(self, connections: Connections, post: Post) -> Answer:
        for left in reversed(range(_TRIES)):
            try:
                answer = await connections.send(post)
            except OSError:
                if not self.insist or not left:
                    raise
            else:
                if not (self.insist and left and answer.status >= _SERVER_ERROR):
                    return answer
            await asyncio.sleep(_AGAIN_S)
        raise AssertionError("unreachable")

    def _post(self, upload: Upload, url: str) -> Post:
        headers = {"Authorization": f"Bearer {self.tokens[upload.student]}"}
        if self.insist:
            headers["Idempotency-Key"] = f"{upload.script.assignment} {upload.attempt} {upload.kind}"
        form = {"assignment": upload.script.assignment}
        return prepared(url, ADDRESS, headers, form, (upload.script.name, upload.content))


def answered_within(client: httpx.Client, limit_s: float) -> float:
    """Return the share of accepted uploads that took the API process behind `client` no longer than `limit_s`."""
    wanted = {"method": "POST", "route": ADDRESS, "status": "202"}
    counts: dict[str, float] = {}
    for family in text_string_to_metric_families(client.get("/metrics").raise_for_status().text):
        for sample in family.samples:
            if (
                sample.name == "grader_http_request_seconds_bucket"
                and wanted.items() <= sample.labels.items()
            ):
                counts[sample.labels["le"]] = sample.value
    return counts[str(limit_s)] / counts["+Inf"]


def steady(count: int, per_s: float, seed: int) -> list[float]:
    """Return `count` instants of a Poisson process, in seconds from the start."""
    chance = random.Random(seed)  # noqa: S311
    instants, now_s = [], 0.0
    for _ in range(count):
        now_s += chance.expovariate(per_s)
        instants.append(now_s)
    return instants


def evening(count: int, seconds: float, seed: int) -> list[float]:
    """Return `count` instants in [0, seconds], ever denser towards the end: the deadline.

    The density grows as ``exp(5 t / seconds)``: of an evening of six hours, 57 % come in the last one.
    """
    chance = random.Random(seed)  # noqa: S311
    most = math.expm1(_STEEPNESS)
    return sorted(seconds * math.log1p(chance.random() * most) / _STEEPNESS for _ in range(count))


def crowded_since(received: Sequence[float], finished: Sequence[float], slots: int) -> float:
    """Return from when on more was open than `slots` grade at once, until the last upload came."""
    events = sorted([*((at, 1) for at in received), *((at, -1) for at in finished)])
    last, since, open_ = max(received), min(received), 0
    for at, change in events:
        open_ += change
        if at <= last and open_ <= slots:
            since = at
    return since
