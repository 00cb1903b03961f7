"""What leaves the jail, and when time needs the world's consent."""

import struct
from collections.abc import Callable
from typing import Any

RunScript = Callable[..., Any]
S = 10**9
HEAD = "import time\nfrom rclpy._link import link\nfrom rclpy._kernel import kernel\n"
POSE = "link.register('subscription', '/n', '/turtle1/pose', 'turtlesim/msg/Pose')"
TWIST = "link.register('publisher', '/n', '/turtle1/cmd_vel', 'geometry_msgs/msg/Twist')"
RESET = "link.register('client', '/n', '/reset', 'std_srvs/srv/Empty')"


def test_entities_are_announced_with_ids_in_order(run_bare: RunScript) -> None:
    run = run_bare(
        HEAD + "print(link.register('node', '/n'))\ntime.sleep(1)\n"
        "print(link.register('publisher', '/n', '/a', 'std_msgs/msg/String', False, True, 7))\n"
        "link.unregister(2)\n"
    )
    assert run.stdout == "1\n2\n"
    node, publisher = run.of("ENTITY")
    assert (node["what"], node["t_ns"], node["node"], node["name"], node["type"]) == (1, 0, "/n", "", "")
    assert (publisher["t_ns"], publisher["reliability"], publisher["durability"], publisher["depth"]) == (
        S,
        2,
        1,
        7,
    )
    assert run.of("GONE") == [{"kind": "GONE", "id": 2, "t_ns": S}]


def test_only_topics_the_world_listens_to_carry_their_messages(run_bare: RunScript) -> None:
    run = run_bare(
        HEAD
        + f"a = {TWIST}\nb = link.register('publisher', '/n', '/turtle1/cmd_vel', 'std_msgs/msg/String')\n"
        "c = link.register('publisher', '/n', '/rosout', 'rcl_interfaces/msg/Log')\n"
        "print(link.wants(a), link.wants(b), link.wants(c))\n"
        "for i in range(250):\n    link.publish(b, b'no')\nlink.publish(a, b'twist'); link.publish(c, b'log')\n"
    )
    assert run.stdout == "True False True\n"
    assert [(f["id"], f["cdr"]) for f in run.of("PUBLISH")] == [(2, b"")] * 3 + [(1, b"twist"), (3, b"log")]


def test_a_script_that_only_commands_never_asks_for_time(run_bare: RunScript) -> None:
    run = run_bare(HEAD + f"a = {TWIST}\nfor _ in range(5):\n    link.publish(a, b'x')\n    time.sleep(1)\n")
    assert run.of("ADVANCE") == []
    assert [f["t_ns"] for f in run.of("PUBLISH")] == [0, S, 2 * S, 3 * S, 4 * S]


def test_a_subscription_to_the_world_couples_time(run_bare: RunScript) -> None:
    feed = [(t, "/turtle1/pose", struct.pack("<q", t)) for t in (16_000_000, 32_000_000, 48_000_000)]
    run = run_bare(
        HEAD + f"got = []\na = {POSE}\nlink.attach(a, lambda *e: got.append((kernel.now_ns, *e)))\n"
        "print(link.coupled)\ntime.sleep(0.04)\nprint([e[2] for e in got], [e[3].hex() for e in got][0])\n"
        "link.unregister(a)\nprint(link.coupled)\ntime.sleep(1)\n",
        feed=feed,
    )
    assert run.stdout == "True\n[16000000, 32000000] 0024f40000000000\nFalse\n"
    assert [(f["t_ns"], f["together_ns"]) for f in run.of("ADVANCE")] == [(40_000_000, 40_000_000)]


def test_a_request_couples_time_until_it_is_answered(run_bare: RunScript) -> None:
    run = run_bare(
        HEAD + f"a = {RESET}\ngot = []\nlink.attach(a, lambda *e: got.append(e))\nprint(link.coupled)\n"
        "link.request(a, 7, b'ask')\nprint(link.coupled, kernel.wait(lambda: bool(got), None, 'call'), got)\n"
        "print(link.coupled, kernel.now_ns)\n",
        services={"/reset": lambda cdr: b"answer to " + cdr},
    )
    assert run.stdout == "False\nTrue True [(7, 1000000, b'answer to ask')]\nFalse 1000000\n"


def test_a_coupled_wait_without_events_lasts_until_the_horizon(run_bare: RunScript) -> None:
    run = run_bare(
        HEAD + f"{POSE}\ntry: kernel.wait(lambda: False, None, 'x')\n"
        "except KeyboardInterrupt: print(kernel.now_ns)\ntime.sleep(1)\n",
        horizon_s=5,
    )
    assert run.stdout == f"{5 * S}\n"
    assert [f["t_ns"] for f in run.of("ADVANCE")] == [5 * S]


def test_times_never_decrease_from_frame_to_frame(run_bare: RunScript) -> None:
    feed = [(t, "/turtle1/pose", b"") for t in range(16_000_000, 2 * S, 16_000_000)]
    run = run_bare(
        HEAD + f"import threading\na = {TWIST}\nb = {POSE}\ndef work():\n    while True:\n"
        "        kernel.charge(); link.publish(a, b'x')\n"
        "threading.Thread(target=work, daemon=True).start()\n"
        "while True:\n    time.sleep(0.013)\n    link.publish(a, b'y')\n",
        feed=feed,
        horizon_s=2,
    )
    times = [f["t_ns"] for f in run.frames if f["kind"] not in ("EXIT", "NOTE")]
    assert times == sorted(times)
    assert len(times) > 1000
    assert run.exit["t_ns"] == 2 * S


def test_frames_are_sent_in_batches_and_every_one_arrives(run_bare: RunScript) -> None:
    run = run_bare(
        HEAD + f"a = {TWIST}\nlink.publish(a, bytes(52))\nsent = []\nchannel = link._channel\nclass Spy:\n"
        "    def sendall(self, data): sent.append(len(data)); channel.sendall(data)\nlink._channel = Spy()\n"
        "for _ in range(2500): link.publish(a, bytes(52))\nprint(sent)\n"
    )
    assert run.stdout == "[8009, 8009]\n"  # a thousand times of eight bytes each; the rest comes before EXIT
    assert len(run.of("PUBLISH")) == 2501
    assert len(run.raw) < 10


def test_repetitions_end_where_anything_else_is_published(run_bare: RunScript) -> None:
    run = run_bare(
        HEAD
        + f"a = {TWIST}\nb = link.register('publisher', '/n', '/turtle1/cmd_vel', 'geometry_msgs/msg/Twist')\n"
        "for ident, data in ((a, b'x'), (a, b'x'), (b, b'x'), (a, b'x'), (a, b'x'), (a, b'y'), (a, b'y')):\n"
        "    time.sleep(0.1); link.publish(ident, data)\n"
    )
    told = [(f["id"], f["cdr"], f["t_ns"] // 100_000_000) for f in run.of("PUBLISH")]
    assert [cdr for _, cdr, _ in told] == [b"x"] * 5 + [b"y"] * 2
    assert [ident - told[0][0] for ident, *_ in told] == [0, 0, 1, 0, 0, 0, 0]
    assert [at for *_, at in told] == [1, 2, 3, 4, 5, 6, 7]


def test_what_a_killed_script_did_is_known(run_bare: RunScript) -> None:
    """Entities, notes, log records and changed commands leave at once; repetitions wait up to a second."""
    run = run_bare(
        HEAD + f"a = {TWIST}\nsent = []\nchannel = link._channel\nclass Spy:\n"
        "    def sendall(self, data): sent.append(data.count(b'v')); channel.sendall(data)\n"
        "link._channel = Spy()\n"
        "def total(call, *args):\n    before = len(sent)\n    call(*args)\n    return len(sent) - before\n"
        "print(total(link.register, 'node', '/n'), total(link.note, 'x'), total(link.publish, a, b'v1'))\n"
        "print([total(link.publish, a, b'v1') for _ in range(3)], total(link.publish, a, b'v2'), sent[-1])\n"
        "for pause_s in (0.9, 0.1): time.sleep(pause_s); print(total(link.publish, a, b'v2'))\n"
    )
    assert run.stdout == "1 1 1\n[0, 0, 0] 1 1\n0\n1\n"
    assert [frame["cdr"] for frame in run.of("PUBLISH")] == [b"v1"] * 4 + [b"v2"] * 3


def test_a_flood_of_news_is_sent_in_batches(run_bare: RunScript) -> None:
    run = run_bare(
        HEAD + f"a = {TWIST}\nsent = []\nchannel = link._channel\nclass Spy:\n"
        "    def sendall(self, data): sent.append(len(data)); channel.sendall(data)\nlink._channel = Spy()\n"
        "for i in range(9000): link.publish(a, i.to_bytes(52, 'little'))\nprint(len(sent))\n"
    )
    assert 200 < int(run.stdout) < 300
    assert len(run.of("PUBLISH")) == 9_000


def test_many_news_wait_no_longer_than_a_quarter_of_a_second(run_bare: RunScript) -> None:
    """Whoever steers by each pose publishes 62 different commands a second."""
    run = run_bare(
        HEAD + f"a = {TWIST}\nsent = []\nchannel = link._channel\nclass Spy:\n"
        "    def sendall(self, data): sent.append(kernel.now_ns); channel.sendall(data)\nlink._channel = Spy()\n"
        "for i in range(600):\n    time.sleep(0.02)\n    link.publish(a, i.to_bytes(52, 'little'))\n"
        "late = [b - a for a, b in zip(sent[200:], sent[201:])]\nprint(len(late), min(late), max(late))\n"
    )
    count, least_ns, most_ns = map(int, run.stdout.split())
    assert count >= 25
    assert 250_000_000 <= least_ns <= most_ns < 280_000_000


def test_there_is_a_bound_on_entities(run_bare: RunScript) -> None:
    run = run_bare(HEAD + "for i in range(8_200): link.register('node', f'/n{i}')\n")
    assert len(run.of("ENTITY")) == 8_192
    assert run.exit["type"] == "RuntimeError"


def test_the_process_ends_when_the_episode_has_gone(run_bare: RunScript) -> None:
    run = run_bare(
        HEAD + "import os\nos.close(link._channel._number)\nlink.note('a')\nlink.flush()\nprint('never')\n"
    )
    assert (run.returncode, run.stdout) == (0, "")
