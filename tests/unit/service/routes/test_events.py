"""Live progress: what is told, to whom, how often, and that nobody who watches costs anything."""

import json
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from threading import Event
from typing import Any

import httpx
import pytest

from grader.contracts.errors import InfrastructureError
from grader.contracts.submission import Claim
from grader.use_cases.services import Services
from tests.fakes import grading, server
from tests.fakes.clock import FakeClock
from tests.fakes.waiting import PATIENCE_S, wait_until


class Stream:
    """An open stream of events."""

    def __init__(self, response: httpx.Response) -> None:
        self.response = response
        self._lines = response.iter_lines()

    def blocks(self) -> Iterator[dict[str, str]]:
        """Yield what stands between two empty lines, comments left out."""
        block: dict[str, str] = {}
        for line in self._lines:
            name, _, value = line.partition(": ")
            if not line and block:
                yield block
                block = {}
            elif line and not line.startswith(":"):
                block[name] = value

    def events(self) -> Iterator[dict[str, Any]]:
        """Yield events with their data read."""
        for block in self.blocks():
            if "event" in block:
                yield {**block, "data": json.loads(block["data"])}


@contextmanager
def opened(client: httpx.Client, url: str, headers: dict[str, str] | None = None) -> Iterator[Stream]:
    with client.stream("GET", url + "/events", headers=headers) as response:
        assert response.status_code == 200, response.read()
        yield Stream(response)


def claimed(services: Services) -> Claim:
    claim = services.queue.claim("w")
    assert claim is not None
    services.doorbell.ring()
    return claim


def finish(services: Services, claim: Claim) -> None:
    grading.finish(services.queue, services.assignments, claim)
    services.doorbell.ring()


@pytest.fixture
def limited(services: Services) -> Callable[..., None]:
    def limit(**changes: float) -> None:
        services.watching.limits = replace(services.watching.limits, **changes)

    return limit


def test_a_submission_is_followed_to_its_end(
    client: httpx.Client, services: Services, upload: Callable[..., httpx.Response], clock: FakeClock
) -> None:
    upload(student="s0")
    clock.advance(1)
    url = upload().headers["Location"]
    with opened(client, url) as stream:
        assert stream.response.headers["content-type"].startswith("text/event-stream")
        assert stream.response.headers["cache-control"] == "private, no-cache"
        events = stream.events()
        told = [next(events)]
        finish(services, claimed(services))
        told.append(next(one for one in events if one["data"]["queue_position"] == 0))
        claim = claimed(services)
        told.append(next(one for one in events if one["data"]["status"] == "running"))
        finish(services, claim)
        told += list(events)
    assert [(one["event"], one["data"]["status"], one["data"]["queue_position"]) for one in told] == [
        ("progress", "queued", 1),
        ("progress", "queued", 0),
        ("progress", "running", None),
        ("progress", "graded", None),
    ]
    assert [one["data"]["open"] for one in told] == [True, True, True, False]
    assert len({one["id"] for one in told}) == 4


def test_an_event_says_nothing_of_the_grading(client: httpx.Client, graded: Callable[..., str]) -> None:
    with opened(client, graded(), {"Accept-Language": "zh"}) as stream:
        first, event = stream.blocks()
    assert first == {"retry": "2000"}
    assert json.loads(event["data"]) == {
        "status": "graded",
        "text": "已评分",
        "open": False,
        "queue_position": None,
        "estimated_finish_at": None,
    }


def test_what_was_received_is_not_repeated(
    client: httpx.Client, services: Services, upload: Callable[..., httpx.Response]
) -> None:
    url = upload().headers["Location"]
    with opened(client, url) as stream:
        seen = next(stream.events())["id"]
    with opened(client, url, {"Last-Event-ID": seen}) as stream:
        claim = claimed(services)
        event = next(stream.events())
        assert event["data"]["status"] == "running"
    finish(services, claim)
    with opened(client, url, {"Last-Event-ID": event["id"]}) as stream:
        (last,) = stream.events()
    response = client.get(url + "/events", headers={"Last-Event-ID": last["id"]})
    assert (response.status_code, response.content) == (204, b"")


def test_a_stream_ends_and_is_opened_again(
    client: httpx.Client, upload: Callable[..., httpx.Response], limited: Callable[..., None]
) -> None:
    limited(life_s=0.05)
    url = upload().headers["Location"]
    with opened(client, url) as stream:
        (event,) = stream.events()
    with opened(client, url, {"Last-Event-ID": event["id"]}) as stream:
        assert list(stream.blocks()) == [{"retry": "2000"}]


def test_a_person_has_so_many_streams_and_the_service_too(
    client: httpx.Client,
    services: Services,
    upload: Callable[..., httpx.Response],
    school: Any,
    limited: Callable[..., None],
) -> None:
    limited(most_each=2, most=3)
    own = {
        person: upload(student="", headers=school.as_(person)).headers["Location"] for person in ("li", "han")
    }
    li, han = school.as_("li"), school.as_("han")
    with ExitStack() as stack:
        streams = [stack.enter_context(opened(client, own["li"], li)) for _ in range(2)]
        refused = client.get(own["li"] + "/events", headers=li)
        assert (refused.status_code, refused.json()["code"]) == (429, "too_many_streams")
        assert refused.json()["fix"]
        assert int(refused.headers["Retry-After"]) > 0
        streams.append(stack.enter_context(opened(client, own["han"], han)))
        refused = client.get(own["han"] + "/events", headers=han)
        assert (refused.status_code, refused.json()["code"]) == (503, "streams_full")
        assert all(next(stream.events()) for stream in streams)
    wait_until(lambda: services.watching.streams == 0)  # the server learns later that a client is gone
    with opened(client, own["li"], li) as stream:
        assert next(stream.events())["data"]["status"] == "queued"


def test_one_address_has_half_of_the_streams_where_nobody_is_asked_who_they_are(
    client: httpx.Client, upload: Callable[..., httpx.Response], limited: Callable[..., None]
) -> None:
    limited(most_each=10, most=4)
    mine = [upload(student=name).headers["Location"] for name in ("a", "b", "c")]
    with ExitStack() as stack:
        for location in mine[:2]:
            stack.enter_context(opened(client, location))
        refused = client.get(mine[2] + "/events")
        assert (refused.status_code, refused.json()["code"]) == (429, "too_many_streams")
        staff = {"Authorization": f"Bearer {server.TOKEN}"}
        stack.enter_context(opened(client, mine[2], staff))


def test_one_look_serves_all_who_watch(
    client: httpx.Client,
    services: Services,
    upload: Callable[..., httpx.Response],
    clock: FakeClock,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    urls = []
    for number in range(4):
        urls.append(upload(student=f"s{number}").headers["Location"])
        clock.advance(1)
    asked: list[set[str]] = []
    plain = services.watching._standings.of

    def noted(submissions: set[str]) -> Any:
        asked.append(set(submissions))
        return plain(submissions)

    with ExitStack() as stack:
        streams = [stack.enter_context(opened(client, url)).events() for url in urls for _ in range(2)]
        for stream in streams:
            next(stream)
        monkeypatch.setattr(services.watching._standings, "of", noted)
        claim = claimed(services)
        assert [next(streams[0])["data"]["status"], next(streams[1])["data"]["status"]] == ["running"] * 2
        monkeypatch.undo()
    assert claim.submission_id in urls[0]
    assert {len(one) for one in asked} == {4}


def test_a_database_that_is_away_for_a_while_ends_no_stream(
    client: httpx.Client,
    services: Services,
    upload: Callable[..., httpx.Response],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    url = upload().headers["Location"]
    failed = Event()

    def away(submissions: set[str]) -> Any:
        failed.set()
        raise InfrastructureError("the database does not answer")

    with opened(client, url) as stream:
        events = stream.events()
        next(events)
        with monkeypatch.context() as patch:
            patch.setattr(services.watching._standings, "of", away)
            claimed(services)
            assert failed.wait(PATIENCE_S)
        assert next(events)["data"]["status"] == "running"


def test_when_the_service_stops_streams_end_at_once(
    client: httpx.Client, services: Services, upload: Callable[..., httpx.Response]
) -> None:
    url = upload().headers["Location"]
    with opened(client, url) as stream:
        events = stream.events()
        next(events)
        services.watching.end()
        assert list(events) == []
    assert client.get(url + "/events").json()["code"] == "unavailable"
    services.watching.close()


def test_a_class_is_followed_by_its_own_staff(
    client: httpx.Client,
    services: Services,
    upload: Callable[..., httpx.Response],
    school: Any,
    limited: Callable[..., None],
) -> None:
    limited(poll_s=0.01)
    upload(student="", headers=school.as_("li"))
    with (
        opened(client, "/api/v1/dashboard", school.as_("ta")) as mine,
        opened(client, "/api/v1/dashboard", school.as_("zhao")) as other,
    ):
        events = mine.events()
        first = next(events)
        assert (first["event"], first["data"]) == (
            "class",
            {"queued": 1, "running": 0, "graded": 0, "infrastructure_error": 0},
        )
        assert next(other.events())["data"]["queued"] == 0
        finish(services, claimed(services))
        last = next(one for one in events if one["data"]["graded"] == 1)
    assert last["data"]["queued"] == 0
    assert last["id"] != first["id"]


def test_the_page_that_waits_is_told_by_its_cookie(client: httpx.Client, graded: Callable[..., str]) -> None:
    page = graded(student="s1").replace("/api/v1", "")
    assert client.get(page + "/events").status_code == 303
    with opened(client, page, {"Cookie": "grader_student=s1; grader_language=en"}) as stream:
        (event,) = stream.events()
    assert event["data"]["text"] == "graded"
    assert client.get(page + "/events", headers={"Cookie": "grader_student=s2"}).status_code == 404
