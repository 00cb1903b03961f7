from grader.sim.feeds import MAX_EVENTS, MAX_QUEUED, Outbox
from grader.sim.frames import Event, Request


def test_a_message_reaches_every_listener_until_it_leaves() -> None:
    outbox = Outbox()
    outbox.subscribe("/a", 1)
    outbox.subscribe("/a", 2)
    outbox.subscribe("/b", 3)
    outbox.publish("/a", 5, b"x")
    outbox.unsubscribe(1)
    outbox.unsubscribe(9)
    outbox.publish("/a", 5, b"y")
    assert outbox.take() == (5, [Event(1, 1, 0, 5, b"x"), Event(1, 2, 0, 5, b"x"), Event(1, 2, 0, 5, b"y")])
    outbox.unsubscribe(2)
    assert not outbox.has_listeners("/a")
    assert not outbox


def test_one_instant_is_taken_at_a_time() -> None:
    outbox = Outbox()
    outbox.reply(Request(4, 8, 0, b""), 5, b"x")
    outbox.reply(Request(4, 9, 0, b""), 6, b"y")
    assert outbox.take() == (5, [Event(2, 4, 8, 5, b"x")])
    assert outbox.take() == (6, [Event(2, 4, 9, 6, b"y")])


def test_what_nobody_looks_at_one_by_one_travels_together() -> None:
    outbox = Outbox()
    for t_ns in (5, 6, 7):
        outbox.add(Event(1, 1, 0, t_ns, b""))
    now_ns, events = outbox.take(6)
    assert (now_ns, [event.t_ns for event in events]) == (6, [5, 6])
    assert outbox.take(6) == (7, [Event(1, 1, 0, 7, b"")])


def test_an_answer_that_is_cut_reaches_its_last_event() -> None:
    outbox = Outbox()
    for t_ns in range(MAX_EVENTS + 1):
        outbox.add(Event(1, 1, 0, t_ns, b""))
    now_ns, events = outbox.take(1_000_000)
    assert (now_ns, len(events)) == (MAX_EVENTS - 1, MAX_EVENTS)
    assert outbox.first_ns == MAX_EVENTS


def test_answers_and_queue_are_bounded() -> None:
    outbox = Outbox()
    for _ in range(MAX_QUEUED + 3):
        outbox.add(Event(1, 1, 0, 7, b""))
    taken = 0
    while outbox:
        now_ns, events = outbox.take()
        assert now_ns == 7
        assert 0 < len(events) <= MAX_EVENTS
        taken += len(events)
    assert taken == MAX_QUEUED
