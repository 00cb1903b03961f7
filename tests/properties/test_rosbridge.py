"""Random frames against the rosbridge core: nothing raises, and nothing grows."""

import gc
import json
import random
import sys
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grader.sim.driving import Car
from grader.sim.rosbridge import bridge as limits
from grader.sim.rosbridge.frames import FrameError, read_frame
from grader.sim.rosbridge.session import LiveSession
from tests.examples import examples

OPS = (
    *("advertise", "unadvertise", "publish", "subscribe", "unsubscribe", "call_service", "advertise_service"),
    *("unadvertise_service", "service_response", "send_action_goal", "cancel_action_goal", "fragment"),
    *("set_level", "status", "auth", "png", "", 5),
)
NAMES = (
    *("/rosapi/set_param", "/rosapi/get_param_names"),
    *(
        "/turtle1/cmd_vel",
        "/turtle1/pose",
        "/chatter",
        "/odom",
        "/tf",
        "/camera/image_raw/compressed",
        "x",
        "",
    ),
    *("/rosapi/topics", "/rosapi/message_details", "/spawn", "/kill", "/reset", "/turtle1/set_pen", "/mine"),
    *(
        "/turtle1/rotate_absolute",
        "/emergency_stop",
        "/turtlesim/set_parameters",
        "/rosapi/set_param",
        "/rosapi/get_param_names",
        "/turtle2/cmd_vel",
    ),
)
TYPES = (
    "geometry_msgs/Twist",
    "std_msgs/msg/String",
    "turtlesim/msg/Pose",
    "std_srvs/Trigger",
    "x/y",
    "",
    None,
)
VALUES = (
    0,
    1,
    -1,
    1e308,
    0.5,
    None,
    "now",
    "",
    "turtle2",
    "AAAA",
    [],
    [1, 2.5, 0, "a"],
    True,
    {"data": True},
)
FIELDS = (
    *(
        "linear",
        "angular",
        "x",
        "y",
        "z",
        "theta",
        "name",
        "data",
        "header",
        "stamp",
        "sec",
        "names",
        "type",
        "r",
    ),
)
FRAMES, CLIENTS = 10_000, range(1, 5)


def frame(draw: random.Random) -> str:
    """Return a frame that is nearly right: most of its fields exist, many values fit."""
    body: dict[str, Any] = {"op": draw.choice(OPS)}
    for field in ("topic", "service", "action"):
        if draw.random() < 0.9:
            body[field] = draw.choice(NAMES)
    if draw.random() < 0.7:
        body["type"] = draw.choice(TYPES)
    for field in ("msg", "args", "values"):
        if draw.random() < 0.6:
            body[field] = message(draw, 3)
    for field, choices in (
        ("id", ("a", "b", 7, None, "service_request:/mine:1048600")),
        ("throttle_rate", (0, 50, -1, "x")),
        ("queue_length", (0, 1, 1e300)),
        ("fragment_size", (0, 200, 3)),
        ("feedback", (True, False, 1)),
        ("num", (0, 1, 2.0)),
        ("total", (1, 2, 1e9)),
        ("timeout", (0, 0.1, -1)),
    ):
        if draw.random() < 0.3:
            body[field] = draw.choice(choices)
    if body["op"] == "fragment":
        body["data"] = json.dumps({"op": "publish", "topic": "/turtle1/cmd_vel"})[: draw.randrange(60)]
    text = json.dumps(body)
    return (
        text if draw.random() < 0.9 else text[: draw.randrange(len(text))] + draw.choice(("", "}", "\0", "é"))
    )


def message(draw: random.Random, depth: int) -> Any:
    if not depth or draw.random() < 0.4:
        return draw.choice(VALUES)
    return {draw.choice(FIELDS): message(draw, depth - 1) for _ in range(draw.randrange(4))}


@pytest.fixture(scope="module")
def car() -> Iterator[Car]:
    car = Car()
    yield car
    car.close()


def kept(session: LiveSession) -> dict[str, int]:
    """Return how much the bridge and the world keep for clients."""
    bridge, world = session._bridge, session._world
    clients = bridge._clients.values()
    return {
        "waiting": len(bridge._waiting),
        "heard": len(bridge._heard),
        "relays": len(bridge._relays),
        "offered": len(bridge._offered),
        "subscriptions": sum(len(one.subscriptions) for one in clients),
        "advertised": sum(len(one.advertised) for one in clients),
        "goals": len(bridge._goals._under_way),
        "carried": len(world._world.carried),
        "answers": len(world._answers),
    }


def storm(session: LiveSession, draw: random.Random, now_ns: int) -> tuple[int, int]:
    """Send `FRAMES` frames from four clients that come and go; return how many answers came, and the instant."""
    answered = 0
    for number in range(FRAMES):
        if number % 500 == 0:
            for client in CLIENTS:
                session.close(client)
                session.open(client)
        now_ns += draw.choice((0, 1_000_000, 16_000_000))
        session.receive(draw.choice(CLIENTS), frame(draw), now_ns)
        session.advance(now_ns)
        for out in session.take():
            answered += 1
            if out.close:  # too many errors: it connects again
                session.open(out.client)
            else:
                json.loads(out.text)
    return answered, now_ns


def calm(session: LiveSession, now_ns: int) -> tuple[int, int]:
    """Let all clients go and all that is under way end; return the memory blocks in use, and the instant."""
    for client in CLIENTS:
        session.close(client)
    now_ns += 120 * 1_000_000_000
    session.advance(now_ns)
    session.take()
    gc.collect()
    return sys.getallocatedblocks(), now_ns


@pytest.mark.slow
def test_ten_thousand_random_frames_raise_nothing_and_leave_nothing(car: Car) -> None:
    draw, session = random.Random(20_260_301), LiveSession(car, 0)
    answered, now_ns = storm(session, draw, 0)
    assert answered > FRAMES / 2
    most = kept(session)
    assert most["waiting"] <= limits.MOST_WAITING * len(CLIENTS)
    assert most["subscriptions"] <= limits.MOST_TOPICS * len(CLIENTS)
    blocks, now_ns = calm(session, now_ns)
    left = kept(session)
    assert left.pop("carried") <= 2
    assert set(left.values()) == {0}, left

    # nor does anything grow that nobody thought of: what is imported and remembered is there by now
    _, now_ns = storm(session, draw, now_ns)
    more, _ = calm(session, now_ns)
    assert more - blocks < FRAMES / 10


@settings(max_examples=examples(400), deadline=None)
@given(
    st.binary(max_size=300)
    | st.text(max_size=200)
    | st.binary(max_size=80).map(lambda some: b'{"op":"publish","topic":"' + some + b'"}')
)
def test_any_bytes_are_a_frame_or_refused(text: bytes | str) -> None:
    with suppress(FrameError):
        read_frame(text)


def test_bytes_that_are_no_utf_8_are_refused() -> None:
    for data in (
        b'{"op":"publish","topic":"\xff"}',
        b'{"op":"\xff"}',
        b"\xff",
        b'{"op":"auth","id":"\xc3("}',
    ):
        with pytest.raises(FrameError):
            read_frame(data)
