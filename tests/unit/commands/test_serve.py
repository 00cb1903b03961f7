import argparse
import asyncio
import gc
import socket

import pytest
from fastapi import FastAPI

from grader.commands.serve import _Server, configure


def test_garbage_is_collected_once_a_server_has_started(monkeypatch: pytest.MonkeyPatch) -> None:
    """Starting, it is not: `grader.__main__` turns that off."""

    async def started_and_stopped() -> bool:
        server.lifespan = server.config.lifespan_class(server.config)
        with socket.create_server(("127.0.0.1", 0)) as listener:
            await server.startup([listener])
            enabled = gc.isenabled()
            await server.shutdown()
        return enabled

    server = _Server(FastAPI(), 100)
    server.config.load()
    monkeypatch.setattr(gc, "freeze", lambda: None)
    gc.disable()
    try:
        assert asyncio.run(started_and_stopped())
    finally:
        gc.enable()


@pytest.mark.parametrize("text", ["abc", "1_0", "１０"])
def test_options_take_plain_digits(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    parser = argparse.ArgumentParser()
    configure(parser)
    with pytest.raises(SystemExit):
        parser.parse_args(["--port", text])
    assert text in capsys.readouterr().err
    assert parser.parse_args(["--port", "10"]).port == 10
