import gc
import logging
import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import pytest

from grader.commands.cli import run


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--slots", "0"], "would grade nothing"),
        (["--slots", "-1"], "slots"),
        (["--database-url", "mysql://x/y"], "database_url"),
    ],
)
def test_a_worker_that_could_not_work_says_why(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    handlers = logging.getLogger().handlers
    assert run(["worker", *arguments, "--lang", "en"]) == 2
    assert said in capsys.readouterr().err
    assert logging.getLogger().handlers is handlers  # a refused command leaves the process as it was


def test_a_worker_makes_no_database(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["worker", "--data", str(tmp_path / "typo"), "--lang", "en"]) == 2
    assert "there is no database; check --data" in capsys.readouterr().err
    assert not (tmp_path / "typo").exists()


def test_garbage_is_collected_once_a_worker_has_started(
    sqlite_url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Starting, it is not: `grader.__main__` turns that off."""

    class Worker(SimpleNamespace):
        @property
        def id(self) -> str:
            """Asked for when all that is said of a start is said."""
            os.kill(os.getpid(), signal.SIGTERM)
            found.append(gc.isenabled())
            return "w"

    @contextmanager
    def running_worker(*_: object) -> Iterator[Worker]:
        yield Worker()

    found: list[bool] = []
    monkeypatch.setattr("grader.service.composition.running_worker", running_worker)
    monkeypatch.setattr("grader.operation.logs.configure", lambda *_: None)
    monkeypatch.setattr(gc, "freeze", lambda: None)
    handlers = {number: signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGINT)}
    gc.disable()
    try:
        assert run(["worker", "--slots", "1", "--database-url", sqlite_url]) == 0
    finally:
        gc.enable()
        for number, handler in handlers.items():
            signal.signal(number, handler)
    assert found == [True]
