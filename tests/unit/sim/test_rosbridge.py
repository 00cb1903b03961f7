"""The rosbridge core against the turtle: what clients send, and what they get, at instants of the test's own."""

import base64
import json
import math
import zlib
from typing import Any

import pytest

from grader.live.car import MOST_UNREAD
from grader.sim.driving import Car
from grader.sim.rosbridge.bridge import BAD_CLIENT, MOST_PARTS, MOST_TOPICS, MOST_WAITING
from grader.sim.rosbridge.session import LiveSession

EPOCH_NS = 1_800_000_000_000_000_000
S = 1_000_000_000
TWIST = "geometry_msgs/msg/Twist"
CMD = "/turtle1/cmd_vel"
POSE = "/turtle1/pose"
ROTATE = "/turtle1/rotate_absolute"


class Table:
    """A session with client 1, and a clock."""

    def __init__(self, car: Car) -> None:
        self.session = LiveSession(car, EPOCH_NS)
        self.session.open(1)
        self.now_ns = 0

    def say(self, frame: dict[str, Any] | str, client: int = 1) -> list[dict[str, Any]]:
        """Send a frame and return what comes back at the next update."""
        text = frame if isinstance(frame, str) else json.dumps(frame)
        self.session.receive(client, text, self.now_ns)
        return self.wait(0.016, client)

    def wait(self, seconds: float, client: int = 1) -> list[dict[str, Any]]:
        self.now_ns += round(seconds * S)
        self.session.advance(self.now_ns)
        return [json.loads(out.text) for out in self.session.take() if out.client == client and not out.close]

    def call(self, service: str, args: Any = None, **more: Any) -> dict[str, Any]:
        (answer,) = self.say({"op": "call_service", "service": service, "args": args, "id": "c", **more})
        assert (answer["op"], answer["service"], answer["id"]) == ("service_response", service, "c")
        return answer

    def pose(self) -> dict[str, float]:
        told = self.say({"op": "subscribe", "topic": POSE, "id": "once"})
        assert self.say({"op": "unsubscribe", "topic": POSE}) == []
        pose: dict[str, float] = told[0]["msg"]
        return pose


@pytest.fixture
def table(car: Car) -> Table:
    return Table(car)


def error(answers: list[dict[str, Any]]) -> str:
    (status,) = answers
    assert (status["op"], status["level"]) == ("status", "error")
    return str(status["msg"])


def test_one_message_without_advertise_drives_for_a_second(table: Table) -> None:
    start = table.pose()
    msg = {"linear": {"x": 1}, "angular": {"z": 0}}
    assert table.say({"op": "publish", "topic": CMD, "type": TWIST, "msg": msg}) == []
    table.wait(2.0)
    assert table.pose()["x"] - start["x"] == pytest.approx(1.0, abs=0.02)


def test_commands_of_all_clients_wait_in_one_line(table: Table) -> None:
    table.session.open(2)
    before = table.pose()
    for x, client in ((3.0, 1), (-3.0, 2), (0.0, 1)):
        table.session.receive(
            client, json.dumps({"op": "publish", "topic": CMD, "msg": {"linear": {"x": x}}}), table.now_ns
        )
    assert table.pose()["linear_velocity"] == 3.0
    table.wait(1.0)
    assert table.pose() == before  # there, back, and at rest
    assert table.pose() == before


def test_poses_come_at_each_update_and_a_throttle_keeps_its_pace(table: Table) -> None:
    table.say({"op": "subscribe", "topic": POSE, "type": "turtlesim/Pose"})
    assert len(table.wait(16.0)) == 1000
    table.say({"op": "unsubscribe", "topic": POSE})
    table.say({"op": "subscribe", "topic": POSE, "throttle_rate": 100, "queue_length": 1})
    assert len(table.wait(16.0)) == pytest.approx(160, abs=2)


def test_an_unknown_id_leaves_the_subscription_as_rosbridge_does(table: Table) -> None:
    table.say({"op": "subscribe", "id": "subscribe_2", "topic": POSE})
    table.say({"op": "unsubscribe", "id": "unsubscribe_3", "topic": POSE})
    assert len(table.wait(0.16)) == 10
    table.say({"op": "unsubscribe", "id": "subscribe_2", "topic": POSE})
    assert table.wait(0.16) == []


def test_clients_talk_on_topics_of_their_own(table: Table) -> None:
    table.session.open(2)
    assert table.say({"op": "subscribe", "topic": "/chatter", "type": "std_msgs/String"}) == []
    assert table.say({"op": "advertise", "topic": "/chatter", "type": "std_msgs/msg/String"}, client=2) == []
    told = {"op": "publish", "topic": "/chatter", "msg": {"data": "小乌龟"}}
    table.session.receive(2, json.dumps(told), table.now_ns)
    assert table.wait(0.0) == [told]
    assert "established with type" in error(
        table.say({"op": "advertise", "topic": "/chatter", "type": "std_msgs/Bool"})
    )
    table.session.close(2)
    table.say({"op": "unsubscribe", "topic": "/chatter"})
    assert "/chatter" not in table.call("/rosapi/topics")["values"]["topics"]


def test_a_header_without_a_stamp_gets_one(table: Table) -> None:
    table.say({"op": "subscribe", "topic": "/points", "type": "geometry_msgs/PointStamped"})
    table.now_ns = 3 * S
    (got,) = table.say({"op": "publish", "topic": "/points", "msg": {"header": {"frame_id": "base"}}})
    assert got["msg"]["header"] == {"stamp": {"sec": EPOCH_NS // S + 3, "nanosec": 0}, "frame_id": "base"}
    for stamp in ({"secs": 7, "nsecs": 8}, {"sec": 7, "nanosec": 8}):
        (got,) = table.say({"op": "publish", "topic": "/points", "msg": {"header": {"stamp": stamp}}})
        assert got["msg"]["header"]["stamp"] == {"sec": 7, "nanosec": 8}


@pytest.mark.parametrize(
    ("frame", "said"),
    [
        ("{", "no single JSON object"),
        ('{"op":"publish","topic":"/a"} {"op":"publish","topic":"/a"}', "no single JSON object"),
        ({"op": "fly"}, "Invalid value 'fly'"),
        ({"op": "publish"}, "missing required field `topic`"),
        ({"op": "publish", "topic": "/cmd_vel", "type": TWIST, "msg": {}}, "not yet advertised"),
        ({"op": "publish", "topic": CMD, "msg": {"linear": {"q": 1}}}, "no field 'q' (msg.linear)"),
        ({"op": "publish", "topic": CMD, "msg": {"linear": {"x": "1"}}}, "msg.linear.x: float64 expected"),
        ({"op": "publish", "topic": CMD, "msg": {"linear": {"x": True}}}, "float64 expected"),
        ({"op": "publish", "topic": CMD, "msg": {"linear": {"x": 10**400}}}, "float64 expected"),
        ({"op": "subscribe", "topic": "/nothing"}, "not yet advertised"),
        ({"op": "subscribe", "topic": "/nothing", "type": "no_msgs/No"}, "Unable to find the type"),
        ({"op": "subscribe", "topic": POSE, "fragment_size": 1}, "at least"),
        ({"op": "advertise", "topic": "/x" * 200}, "length"),
        ({"op": "unadvertise_service", "service": "/x"}, "not offered"),
        ({"op": "service_response", "service": "/x", "id": "1", "values": {}}, "nobody waits"),
        ('{"op":"publish","topic":"/a","msg":' + '{"a":' * 10_800 + "1" + "}" * 10_801, "too deep"),
        (json.dumps({"op": "publish", "topic": CMD, "msg": {"x": "y" * 70_000}}), "at most 65536 bytes"),
    ],
)
def test_what_cannot_be_used_is_answered_by_a_status(table: Table, frame: Any, said: str) -> None:
    assert said in error(table.say(frame))


def test_a_status_names_the_frame_it_is_about(table: Table) -> None:
    (status,) = table.say({"op": "publish", "id": "p7", "topic": "/nowhere"})
    assert status["id"] == "p7"
    (status,) = table.say({"op": "publish", "id": "p8"})
    assert status["id"] == "p8"


def test_a_client_that_only_errs_is_let_go_and_others_stay(table: Table) -> None:
    table.session.open(2)
    for _ in range(30):
        table.session.receive(1, "nonsense", table.now_ns)
    closed = [out for out in table.session.take() if out.close]
    assert [(out.client, out.close) for out in closed] == [(1, BAD_CLIENT)]
    table.session.receive(2, json.dumps({"op": "subscribe", "topic": POSE}), table.now_ns)
    assert len(table.wait(0.16, client=2)) == 10


def test_what_a_client_may_keep_is_bounded(table: Table) -> None:
    for number in range(MOST_TOPICS):
        assert table.say({"op": "subscribe", "topic": f"/t{number}", "type": "std_msgs/String"}) == []
    assert "at most" in error(table.say({"op": "subscribe", "topic": "/more", "type": "std_msgs/String"}))
    table.say({"op": "advertise_service", "service": "/slow", "type": "std_srvs/Trigger"})
    for number in range(MOST_WAITING):
        table.say({"op": "call_service", "service": "/slow", "id": number})
    assert "at most" in table.say({"op": "call_service", "service": "/slow"})[0]["values"]


def test_services_of_the_turtle(table: Table) -> None:
    answer = table.call("/turtle1/teleport_absolute", {"x": 2, "y": 3.5, "theta": 0})
    assert (answer["values"], answer["result"]) == ({}, True)
    assert (table.pose()["x"], table.pose()["y"]) == (2.0, 3.5)
    assert table.call("spawn", [1.0, 1.0, 0.0, "bob"])["values"] == {"name": "bob"}
    assert "/bob/pose" in table.call("rosapi/topics")["values"]["topics"]
    red = table.call("/turtlesim/get_parameters", {"names": ["background_r"]})
    assert red["values"]["values"][0]["integer_value"] == 69


@pytest.mark.parametrize(
    ("service", "args", "said"),
    [
        ("/nope", {}, "Service /nope does not exist"),
        ("/rosapi/nope", {}, "Service /rosapi/nope does not exist"),
        ("/spawn", {"z": 1}, "no field 'z'"),
        ("/spawn", [1, 2, 3, "a", 5], "4 fields, not 5"),
        ("/turtlesim/set_parameters", {"name": "background_r", "value": 200}, "no field 'name'"),
    ],
)
def test_a_call_that_fails_says_why(table: Table, service: str, args: Any, said: str) -> None:
    answer = table.call(service, args, type="whatever/Type")
    assert answer["result"] is False
    assert said in answer["values"]


def test_large_answers_are_given_at_a_bounded_rate(table: Table) -> None:
    ask = json.dumps({"op": "call_service", "service": "/rosapi/interfaces", "id": 1})
    for _ in range(200):
        table.session.receive(1, ask, table.now_ns)
    answers = table.wait(0.0)
    assert len(json.dumps([one for one in answers if one["result"]])) < 1_300_000
    refused = [one for one in answers if not one["result"]]
    assert {one["values"] for one in refused} == {"too many large answers: wait a moment"}
    table.wait(10.0)
    assert table.call("/rosapi/interfaces")["result"] is True


def test_a_request_that_nobody_answers_ends(table: Table) -> None:
    table.say({"op": "advertise_service", "service": "/slow", "type": "std_srvs/Trigger"})
    table.say({"op": "call_service", "service": "/slow", "id": "x"})
    (answer,) = table.wait(61.0)
    assert (answer["result"], answer["id"]) == (False, "x")


def test_a_client_answers_another_ones_request(table: Table) -> None:
    table.session.open(2)
    table.say({"op": "advertise_service", "service": "/say", "type": "std_srvs/Trigger"})
    table.session.receive(2, json.dumps({"op": "call_service", "service": "/say", "id": 5}), table.now_ns)
    (asked,) = table.wait(0.0)
    assert (asked["op"], asked["service"]) == ("call_service", "/say")
    answer = {"op": "service_response", "service": "/say", "id": asked["id"], "values": {"success": True}}
    table.session.receive(1, json.dumps(answer), table.now_ns)
    (got,) = table.wait(0.0, client=2)
    assert (got["values"], got["result"], got["id"]) == ({"success": True}, True, 5)


def test_a_goal_with_feedback_and_its_result(table: Table) -> None:
    goal = {
        "op": "send_action_goal",
        "id": "g",
        "action": ROTATE,
        "action_type": "turtlesim/action/RotateAbsolute",
    }
    answers = table.say({**goal, "args": {"theta": 1.0}, "feedback": True}) + table.wait(1.5)
    *feedback, result = answers
    assert {one["op"] for one in feedback} == {"action_feedback"}
    assert feedback[0]["values"]["remaining"] == pytest.approx(1.0, abs=0.02)
    assert (result["op"], result["status"], result["result"], result["id"]) == ("action_result", 4, True, "g")
    assert table.pose()["theta"] == pytest.approx(1.0, abs=0.03)


def test_goals_are_cancelled_aborted_and_unknown(table: Table) -> None:
    goal = {"op": "send_action_goal", "id": "g", "action": ROTATE, "args": {"theta": 3.0}}
    assert table.say(goal) == []
    table.wait(0.5)
    table.say({"op": "cancel_action_goal", "action": ROTATE, "id": "other"})
    (result,) = table.say({"op": "cancel_action_goal", "action": ROTATE, "id": "g"}) + table.wait(0.1)
    assert result["status"] == 5
    table.say(goal)
    (result,) = table.say({"op": "publish", "topic": CMD, "msg": {}}) + table.wait(0.1)
    assert result["status"] == 6
    (result,) = table.say({**goal, "action": "/nope"})
    assert (result["result"], result["status"]) == (False, 0)


def test_the_emergency_stop_holds_until_it_is_released(table: Table) -> None:
    drive = {"op": "publish", "topic": CMD, "msg": {"linear": {"x": 1.0}}}
    table.say(drive)
    table.wait(0.2)
    assert table.call("/emergency_stop", {"data": True})["values"]["success"] is True
    held = table.pose()
    table.say(drive)
    table.wait(1.0)
    assert table.pose()["x"] == held["x"]
    table.call("/emergency_stop", {"data": False})
    table.say(drive)
    table.wait(1.0)
    assert table.pose()["x"] > held["x"] + 0.9


def test_rosapi_tells_types_and_definitions(table: Table) -> None:
    ask = {
        "/rosapi/topic_type": ({"topic": CMD}, {"type": TWIST}),
        "/rosapi/service_type": ({"service": "/spawn"}, {"type": "turtlesim/srv/Spawn"}),
        "/rosapi/action_servers": ({}, {"action_servers": [ROTATE]}),
        "/rosapi/get_ros_version": ({}, {"version": 2, "distro": "humble"}),
        "/rosapi/subscribers": ({"topic": CMD}, {"subscribers": ["/turtlesim"]}),
        "/rosapi/topics_for_type": ({"type": "turtlesim/Pose"}, {"topics": [POSE]}),
    }
    for service, (args, values) in ask.items():
        assert table.call(service, args)["values"] == values
    twist, vector = table.call("/rosapi/message_details", {"type": "geometry_msgs/Twist"})["values"][
        "typedefs"
    ]
    assert (twist["fieldnames"], vector["fieldtypes"]) == (["linear", "angular"], ["float64"] * 3)
    assert "/rosout" in table.call("/rosapi/topics")["values"]["topics"]


def test_rosapi_reads_and_sets_parameters(table: Table) -> None:
    red = "/turtlesim:background_r"
    assert red in table.call("/rosapi/get_param_names")["values"]["names"]
    assert table.call("/rosapi/get_param", {"name": red})["values"] == {"value": "69"}
    assert table.call("/rosapi/set_param", {"name": red, "value": "200"})["values"] == {}
    assert table.call("/rosapi/get_param", {"name": red, "default_value": "1"})["values"] == {"value": "200"}
    assert (
        table.call("/rosapi/set_param", {"name": red, "value": '"much"'})["values"] == {}
    )  # refused in silence
    assert table.call("/rosapi/has_param", {"name": red})["values"] == {"exists": True}
    for name in ("/turtlesim:nothing", "/nobody:background_r"):
        assert table.call("/rosapi/has_param", {"name": name})["values"] == {"exists": False}
        asked = table.call("/rosapi/get_param", {"name": name, "default_value": "7"})
        assert asked["values"] == {"value": "7"}
    assert table.call("/rosapi/get_param", {"name": "background_r"})["result"] is False


def test_fragments_are_joined_and_sent(table: Table) -> None:
    text = json.dumps({"op": "call_service", "service": "/rosapi/nodes", "id": "n"})
    parts = [text[:20], text[20:]]
    assert table.say({"op": "fragment", "id": "f", "data": parts[1], "num": 1, "total": 2.0}) == []
    (answer,) = table.say({"op": "fragment", "id": "f", "data": parts[0], "num": 0, "total": 2.0})
    assert "/turtlesim" in answer["values"]["nodes"]
    got = table.say({"op": "subscribe", "topic": "/odom", "fragment_size": 200})
    joined = json.loads("".join(one["data"] for one in got))
    assert joined["msg"]["child_frame_id"] == "base_link"


def test_a_message_comes_in_no_more_fragments_than_may_wait_for_a_client(table: Table) -> None:
    chat = {"topic": "/chat", "type": "std_msgs/String"}
    assert table.say({"op": "subscribe", **chat, "fragment_size": 128}) == []
    parts = table.say({"op": "publish", **chat, "msg": {"data": "x" * 60_000}})
    assert len(parts) <= MOST_PARTS < MOST_UNREAD
    joined = json.loads("".join(one["data"] for one in parts))
    assert joined["msg"]["data"] == "x" * 60_000


def test_the_camera_sees_the_line(table: Table) -> None:
    table.say({"op": "publish", "topic": CMD, "msg": {"linear": {"x": 1.0}}})
    table.wait(1.1)
    (seen,) = table.say({"op": "subscribe", "topic": "/camera/image_raw/compressed"})
    picture = base64.b64decode(seen["msg"]["data"])
    assert (seen["msg"]["format"], picture[:8]) == ("png", b"\x89PNG\r\n\x1a\n")
    size = int.from_bytes(picture[16:20])
    start = picture.index(b"IDAT")
    rows = zlib.decompress(picture[start + 4 : start + 4 + int.from_bytes(picture[start - 4 : start])])
    assert len(rows) == size * (size + 1)
    assert rows.count(1) > 10  # the line behind the turtle
    assert math.isclose(len(table.wait(5.0)), 10, abs_tol=1)  # two a second
