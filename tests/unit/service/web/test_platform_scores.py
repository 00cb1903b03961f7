"""What a learning platform is told of scores: each difference once in effect, whatever caused it."""

from collections.abc import Callable
from dataclasses import replace
from datetime import timedelta
from functools import cache
from typing import Any

import httpx
import pytest
from fastapi import FastAPI

from grader.contracts.platform import Platform, PlatformLink
from grader.contracts.rules import LateRule, Rules
from grader.outside.lti.scores import PlatformChannel, Score, Signer, new_key
from grader.outside.signin import Providers
from grader.outside.signin.channel import UnreachableError
from grader.store.audit import Signature
from grader.store.platform_scores import PlatformScores
from grader.store.platforms import KEY_READ_WITHIN
from grader.use_cases.score_sending import send_scores
from grader.use_cases.services import Services, outside_channels
from tests.fakes.platforms import new_platform
from tests.fakes.provider import FakeProvider


@cache
def key() -> tuple[str, str]:
    return new_key()


@cache
def signer() -> Signer:
    """One for all tests: reading a key takes forty milliseconds."""
    return Signer((key()[1],))


@pytest.fixture
def moodle(listening: FakeProvider) -> FakeProvider:
    listening.scores, listening.score_status, listening.down = [], 200, False
    listening.tool_keys = signer().public()
    listening.asked.clear()
    return listening


@pytest.fixture
def linked(services: Services, moodle: FakeProvider, tokens: dict[str, str]) -> Services:
    """A course whose square is an activity of a platform, where `li` is known as 3."""

    def clock_s() -> float:
        return services.clock().timestamp()

    moodle.clock_s = clock_s

    services.platforms.keys(key)
    made = replace(
        services,
        providers=Providers(public_url="https://grader.example.edu"),
        platform_channel=PlatformChannel(signer, clock_s, private=True),
    )
    platform = add_platform(made, moodle)
    link(made, platform, f"{moodle.address}/items/7?type_id=1")
    assert made.identities.bind(platform.provider, "3", "ros", "li", by_token=False)
    return made


def add_platform(
    services: Services, moodle: FakeProvider, issuer: str = "https://moodle.example"
) -> Platform:
    new = new_platform(issuer=issuer, token_url=f"{moodle.address}/access", keys_url=f"{moodle.address}/keys")
    return services.platforms.add(new, Signature(services.clock(), "ros", "wang"))


def link(services: Services, platform: Platform, line_item: str) -> None:
    services.platforms.open_link(
        PlatformLink(
            platform=platform.id,
            resource="7",
            title="走正方形",
            assignment="square",
            line_item=line_item,
            used_at=services.clock(),
        )
    )


def given(moodle: FakeProvider) -> list[float | None]:
    return [one.get("scoreGiven") for one in moodle.scores]


def test_a_score_is_sent_once(linked: Services, moodle: FakeProvider, put: Callable[..., str]) -> None:
    assert send_scores(linked) == 0
    address = put(course="ros", student="li")
    put(course="ros", student="han")  # whom the platform does not know
    assert send_scores(linked) == 1
    assert send_scores(linked) == 0
    (told,) = moodle.scores
    assert told["userId"] == "3"
    assert (told["scoreGiven"], told["scoreMaximum"]) == (5.0, 100.0)
    assert (told["activityProgress"], told["gradingProgress"]) == ("Completed", "FullyGraded")
    assert told["comment"].endswith(f"https://grader.example.edu{address}")
    assert moodle.asked.count("/access") == 1


def test_a_change_by_a_rule_is_sent_and_may_lower_it(
    linked: Services, moodle: FakeProvider, put: Callable[..., str]
) -> None:
    put(course="ros", student="li")
    send_scores(linked)
    due = linked.clock() - timedelta(days=2)
    rules = Rules(due=due, late=LateRule(kind="linear", per_day=0.1))
    linked.rules.set("square", rules, Signature(linked.clock(), "ros", "wang"))
    send_scores(linked)
    assert given(moodle)[0] == 5.0
    assert len(moodle.scores) == 2
    assert given(moodle)[1] < 5.0


def test_two_changes_within_a_second_both_arrive(
    linked: Services, moodle: FakeProvider, put: Callable[..., str]
) -> None:
    """A platform refuses a score that is not later, in whole seconds, than the one it has."""
    put(course="ros", student="li")
    send_scores(linked)
    linked.rules.set(
        "square",
        Rules(hidden_items=(linked.assignments.get("square").items[0].id,)),
        Signature(linked.clock(), "ros", "wang"),
    )
    row = linked.platform_scores.of_link(linked.platforms.links("ros")[0])["li"]
    linked.clock.advance((row.not_before - linked.clock()).total_seconds())
    send_scores(linked)
    assert len(moodle.scores) == 2


def test_hidden_items_do_not_leak(linked: Services, moodle: FakeProvider, put: Callable[..., str]) -> None:
    items = linked.assignments.get("square").items
    hidden = Rules(hidden_items=(items[0].id,), hidden_until=linked.clock() + timedelta(hours=1))
    linked.rules.set("square", hidden, Signature(linked.clock(), "ros", "wang"))
    put(course="ros", student="li")
    send_scores(linked)
    assert moodle.scores[-1]["gradingProgress"] == "PendingManual"
    assert "scoreGiven" not in moodle.scores[-1]
    linked.clock.advance(3_601.0)  # a date passes: nothing else happens
    send_scores(linked)
    assert given(moodle)[-1] == 5.0


@pytest.mark.parametrize("taken", [True, False])
def test_a_clock_that_was_ahead_holds_no_score_up(
    linked: Services, moodle: FakeProvider, put: Callable[..., str], taken: bool
) -> None:
    put(course="ros", student="li")
    linked.clock.advance(86_400.0)
    moodle.down = not taken
    send_scores(linked)
    linked.clock.advance(-86_400.0)
    moodle.down = False
    due = linked.clock() - timedelta(days=2)
    rules = Rules(due=due, late=LateRule(kind="linear", per_day=0.1))
    linked.rules.set("square", rules, Signature(linked.clock(), "ros", "wang"))
    assert send_scores(linked) == 1
    assert given(moodle)[-1] < 5.0


def test_a_platform_that_is_down_loses_nothing(
    linked: Services, moodle: FakeProvider, put: Callable[..., str]
) -> None:
    put(course="ros", student="li")
    moodle.down = True
    for _ in range(6):
        assert send_scores(linked) == 0
        linked.clock.advance(120.0)
    (trouble,) = linked.platform_scores.troubles("ros")
    assert (trouble.person, trouble.tries > 1, "503" in trouble.trouble) == ("li", True, True)
    moodle.down = False
    linked.clock.advance(3_600.0)
    assert send_scores(linked) == 1
    assert given(moodle) == [5.0]
    assert linked.platform_scores.troubles("ros") == ()


@pytest.mark.parametrize(
    "granted",
    [b'{"x":' + b"[" * 100_000, b'{"access_token": "\xff"}', b'{"access_token": 7}', b"", b"[]"],
    ids=["deep", "no text", "a number", "empty", "a list"],
)
def test_a_token_that_cannot_be_read_is_told_as_a_trouble(
    linked: Services,
    moodle: FakeProvider,
    put: Callable[..., str],
    monkeypatch: pytest.MonkeyPatch,
    granted: bytes,
) -> None:
    put(course="ros", student="li")
    monkeypatch.setattr(moodle, "access_token", lambda _: (200, granted))
    assert send_scores(linked) == 0
    (trouble,) = linked.platform_scores.troubles("ros")
    assert (trouble.person, trouble.tries) == ("li", 1)
    assert "/access" in trouble.trouble


def test_a_token_that_never_ends_is_asked_for_again_some_day(
    linked: Services, moodle: FakeProvider, put: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    granted = {"access_token": "t", "expires_in": 10**400}
    monkeypatch.setattr(moodle, "access_token", lambda _: (200, granted))
    put(course="ros", student="li")
    assert send_scores(linked) == 1


def test_a_refused_score_is_tried_ever_more_seldom_and_told(
    linked: Services, moodle: FakeProvider, put: Callable[..., str]
) -> None:
    moodle.score_status = 400
    put(course="ros", student="li")
    tried = []
    for minute in range(30):
        before = moodle.asked.count("/items/7/scores?type_id=1")
        send_scores(linked)
        if moodle.asked.count("/items/7/scores?type_id=1") > before:
            tried.append(minute)
        linked.clock.advance(60.0)
    assert tried == [0, 1, 2, 4, 8, 16]


def test_whoever_dies_between_telling_and_noting_tells_the_same_again(
    linked: Services, moodle: FakeProvider, put: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    put(course="ros", student="li")

    class KilledError(BaseException):
        pass

    def killed(*_: object) -> None:
        raise KilledError

    with monkeypatch.context() as patch:
        patch.setattr(type(linked.platform_scores), "sent", killed)
        with pytest.raises(KilledError):
            send_scores(linked)
    assert send_scores(linked) == 0  # another process holds it for a minute
    linked.clock.advance(61.0)
    assert send_scores(linked) == 1
    assert given(moodle) == [5.0, 5.0]
    assert send_scores(linked) == 0


def test_a_platform_that_stumbles_stops_nobody_elses_scores(
    linked: Services, moodle: FakeProvider, put: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever a platform answers or an error of ours: the other platforms' scores are sent."""
    put(course="ros", student="li")
    (first,) = linked.platforms.of_course("ros")
    second = add_platform(linked, moodle, issuer="https://other.example")
    link(linked, second, f"{moodle.address}/items/7?type_id=1")
    assert linked.identities.bind(second.provider, "4", "ros", "li", by_token=False)
    whole = PlatformChannel.send

    def send(self: PlatformChannel, platform: Platform, *others: object) -> None:
        if platform.id == min(first.id, second.id):
            raise RuntimeError("nobody thought of this")
        whole(self, platform, *others)  # type: ignore[arg-type]

    monkeypatch.setattr(PlatformChannel, "send", send)
    assert send_scores(linked) == 1
    assert len(moodle.scores) == 1


def test_an_address_that_is_none_is_told_as_a_trouble(
    linked: Services, moodle: FakeProvider, put: Callable[..., str]
) -> None:
    (platform,) = linked.platforms.of_course("ros")
    link(linked, platform, "http://a..b/items/7")
    put(course="ros", student="li")
    assert send_scores(linked) == 0
    (trouble,) = linked.platform_scores.troubles("ros")
    assert "a..b" in trouble.trouble


def test_a_score_that_returns_after_an_unheard_answer_is_sent_again(
    linked: Services, moodle: FakeProvider, put: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The platform may have taken what it was not heard to take: what it has is unknown until the next answer."""
    put(course="ros", student="li")
    send_scores(linked)
    whole = PlatformChannel.send

    def unheard(self: PlatformChannel, *asked: object) -> None:
        whole(self, *asked)  # type: ignore[arg-type]
        raise UnreachableError("the connection broke while it answered")

    signed = Signature(linked.clock(), "ros", "wang")
    items = linked.assignments.get("square").items
    linked.clock.advance(2.0)
    with monkeypatch.context() as patch:
        patch.setattr(PlatformChannel, "send", unheard)
        linked.rules.set("square", Rules(hidden_items=(items[0].id,)), signed)
        assert send_scores(linked) == 0
    assert given(moodle) == [5.0, None]
    linked.rules.set("square", Rules(), signed)
    linked.clock.advance(60.0)
    assert send_scores(linked) == 1
    assert given(moodle) == [5.0, None, 5.0]
    assert linked.platform_scores.troubles("ros") == ()


def test_two_processes_that_look_at_once_send_one_score_once(
    linked: Services, moodle: FakeProvider, put: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The second one saw what was known before the first one sent."""
    put(course="ros", student="li")
    store = type(linked.platform_scores)
    (activity,) = linked.platforms.links("ros")
    before = linked.platform_scores.of_link(activity)
    assert send_scores(linked) == 1
    monkeypatch.setattr(store, "of_link", lambda *_: before)
    assert send_scores(linked) == 0
    assert given(moodle) == [5.0]


@pytest.mark.parametrize("how", ["removed", "unbound"])
def test_who_leaves_meanwhile_gets_no_score(
    linked: Services,
    moodle: FakeProvider,
    put: Callable[..., str],
    monkeypatch: pytest.MonkeyPatch,
    how: str,
) -> None:
    put(course="ros", student="li")
    whole = PlatformScores.claim

    def left(*asked: Any) -> Any:
        if how == "removed":
            linked.courses.remove("ros", ["li"], "wang")
        else:
            (bound,) = linked.identities.of_member("ros", "li")
            assert linked.identities.unbind(bound.id, "ros", "li", "wang")
        return whole(*asked)

    monkeypatch.setattr(PlatformScores, "claim", left)
    assert send_scores(linked) == 0
    assert moodle.scores == []
    assert linked.platform_scores.of_link(linked.platforms.links("ros")[0]) == {}


def test_a_new_column_of_the_gradebook_gets_the_scores(
    linked: Services, moodle: FakeProvider, put: Callable[..., str]
) -> None:
    (platform,) = linked.platforms.of_course("ros")
    put(course="ros", student="li")
    link(linked, platform, f"{moodle.address}/items/6")
    assert send_scores(linked) == 0  # that one is not there
    link(linked, platform, f"{moodle.address}/items/7?type_id=1")
    linked.clock.advance(60.0)
    assert send_scores(linked) == 1
    moodle.scores.clear()
    link(linked, platform, f"{moodle.address}/items/7?type_id=1")
    assert send_scores(linked) == 0
    link(linked, platform, "")
    link(linked, platform, f"{moodle.address}/items/7?type_id=1")
    assert send_scores(linked) == 1


def test_a_removed_member_and_platform_leave_nothing(
    linked: Services, moodle: FakeProvider, put: Callable[..., str]
) -> None:
    put(course="ros", student="li")
    send_scores(linked)
    linked.courses.remove("ros", ["li"], "wang")
    assert linked.platform_scores.of_link(linked.platforms.links("ros")[0]) == {}
    (platform,) = linked.platforms.of_course("ros")
    assert linked.platforms.remove(platform.id, Signature(linked.clock(), "ros", "wang"))
    assert linked.platform_scores.targets() == ()


def test_the_keys_are_public_and_have_no_secret(
    client: httpx.Client, running: tuple[FastAPI, str], linked: Services
) -> None:
    running[0].state.services = linked
    shown = client.get("/lti/keys").json()
    assert [one["kid"] for one in shown["keys"]] == [key()[0]]
    assert all("d" not in one for one in shown["keys"])


def test_a_new_key_signs_when_platforms_have_read_it(
    services: Services, moodle: FakeProvider, tokens: dict[str, str], put: Callable[..., str]
) -> None:
    """The running service takes what another process made; no platform meets a key that it cannot know."""
    settings, clock = services.settings, services.clock
    channel = outside_channels(settings, clock, Providers(private_platforms=True), services.platforms)[
        "platform_channel"
    ]

    def shown() -> list[str]:
        return [one["kid"] for one in channel.public_keys()["keys"]]

    (old,) = shown()
    platform, score = add_platform(services, moodle), Score(subject="3", given=5.0, most=100.0, comment="")
    moodle.clock_s, moodle.tool_keys = (lambda: clock().timestamp()), channel.public_keys()
    clock.advance(1.0)
    services.platforms.rotate_key(new_key, at_once=False)
    assert shown()[0] == old
    channel.send(platform, f"{moodle.address}/items/7?type_id=1", score, clock())  # by keys read before
    moodle.tool_keys = channel.public_keys()
    clock.advance(KEY_READ_WITHIN.total_seconds() + 1.0)
    new, other = shown()
    assert (new != old, other) == (True, old)
    channel.send(platform, f"{moodle.address}/items/7?type_id=1", score, clock())
    assert moodle.asked.count("/access") == 2
    for _ in "12":
        services.platforms.rotate_key(new_key, at_once=False)  # nobody has read the one before
    assert (shown()[0], len(shown())) == (new, 2)
