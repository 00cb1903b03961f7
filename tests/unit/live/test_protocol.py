"""The bounded websocket: what it does while its client does not read."""

import asyncio
from unittest.mock import Mock

import uvicorn
from uvicorn.server import ServerState

from grader.live.protocol import BoundedWebSocket


class Quick(BoundedWebSocket):
    unread_s = 0.01


def connected(kind: type[BoundedWebSocket]) -> tuple[BoundedWebSocket, Mock]:
    config = uvicorn.Config(Mock(), log_config=None, ws="none")
    protocol = kind(config=config, server_state=ServerState(), app_state={})
    transport = Mock()
    transport.get_extra_info.return_value = None
    transport.is_closing.return_value = False
    protocol.connection_made(transport)
    return protocol, transport


def test_a_client_that_does_not_read_is_not_read_either_and_then_let_go() -> None:
    async def story() -> Mock:
        protocol, transport = connected(Quick)
        aborted = asyncio.Event()
        transport.abort.side_effect = aborted.set
        protocol.pause_writing()
        transport.pause_reading.assert_called_once()
        await aborted.wait()
        protocol.connection_lost(None)
        return transport

    asyncio.run(story()).resume_reading.assert_not_called()


def test_a_client_that_reads_again_goes_on() -> None:
    async def story() -> Mock:
        protocol, transport = connected(BoundedWebSocket)
        protocol.pause_writing()
        protocol.pause_writing()
        protocol.resume_writing()
        transport.resume_reading.assert_called_once()
        assert protocol._timer is None
        protocol.pause_writing()
        protocol.connection_lost(None)
        assert protocol._timer is None
        return transport

    asyncio.run(story()).abort.assert_not_called()
