"""What waits for a client of a live car: bounded, the newest of each topic, and everything else or nothing."""

import asyncio

from grader.live.car import GONE, MOST_UNREAD, TRY_AGAIN, LiveCar, LiveClient
from grader.live.pipe import TEXT, Parcel, pack, unpack_head


def waiting(client: LiveClient, most: int = 1_000) -> list[bytes]:
    """Return what the client would be sent now."""

    async def read() -> list[bytes]:
        found = []
        while len(found) < most and client._waiting:
            text = await client.next()
            assert text is not None
            found.append(text)
        return found

    return asyncio.run(read())


def test_of_a_topic_the_newest_wait_in_order_beside_all_else() -> None:
    client = LiveClient(1, LiveCar(1))
    for number in range(1_000):
        client.take(Parcel(TEXT, 1, slot=7, depth=3, text=b"pose %d" % number))
        if number % 500 == 0:
            client.take(Parcel(TEXT, 1, text=b"answer %d" % number))
            client.take(Parcel(TEXT, 1, slot=8, depth=1, text=b"colour %d" % number))
    assert waiting(client) == [
        b"answer 0",
        b"answer 500",
        b"colour 500",
        b"pose 997",
        b"pose 998",
        b"pose 999",
    ]
    client.take(Parcel(TEXT, 1, slot=7, depth=3, text=b"again"))
    assert waiting(client) == [b"again"]


def test_who_lets_answers_pile_up_is_let_go() -> None:
    client = LiveClient(1, LiveCar(1))
    for _ in range(MOST_UNREAD + 1):
        client.take(Parcel(TEXT, 1, text=b"answer"))
    assert client.closed == TRY_AGAIN
    assert asyncio.run(client.next()) is None


def test_a_car_that_ends_still_sends_what_waits() -> None:
    client = LiveClient(1, LiveCar(1))
    client.take(Parcel(TEXT, 1, text=b"last words"))
    client.end(GONE, "over")
    assert waiting(client) == [b"last words"]
    assert asyncio.run(client.next()) is None


def test_a_parcel_survives_the_pipe() -> None:
    parcel = Parcel(TEXT, 3, slot=9, depth=10, text="小乌龟".encode())
    data = pack(parcel)
    length, head = unpack_head(data[:-9])
    assert (length, head._replace(text=data[-9:])) == (9, parcel)
