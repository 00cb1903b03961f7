"""The process of a service's own worker, with small programs in its place."""

import os
import signal
import socket
import sys
import threading
from pathlib import Path

import pytest

from grader.contracts.report import GradeStatus
from grader.operation.metrics import Metrics
from grader.operation.settings import Settings
from grader.service.worker import beside
from grader.service.worker.beside import ServiceLink, WorkerProcess, environment_of
from grader.store.work import Doorbell
from tests.fakes.waiting import wait_until

WORKER = """
import os, socket, sys
number = int(sys.argv[-1])
assert sys.argv[-3:-1] == ["worker", "--service"], sys.argv
link = socket.socket(fileno=number)
with open(os.environ["NOTES"], "a") as notes:
    print("started", file=notes, flush=True)
    starts = len(open(os.environ["NOTES"]).read().split())
    if starts == int(os.environ.get("DIES", "0")):
        sys.exit(7)
    link.send(b'["graded", "crashed", 0.25, 3.0]')
    while link.recv(1000):
        link.send(b'["retried", 2]')
        link.send(b'["given_up", 1]')
        link.send(b"\\n")
    print("told to stop", file=notes, flush=True)
    if os.environ.get("HANGS"):
        import time
        time.sleep(600)
"""


class Beside:
    """A service's end, with `WORKER` at the other."""

    def __init__(self, notes: Path) -> None:
        self.notes = notes
        self.doorbell = Doorbell()
        self.metrics = Metrics()
        settings = Settings(database_url="sqlite:///x.db", slots=1, drain_s=0)
        program = (sys.executable, "-S", "-c", WORKER)
        self.worker = WorkerProcess(settings, self.doorbell, self.metrics, program)

    def said(self) -> list[str]:
        return self.notes.read_text().splitlines() if self.notes.exists() else []

    def counted(self, line: str) -> bool:
        return line in self.metrics.exposition().decode().splitlines()


@pytest.fixture
def service(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Beside:
    monkeypatch.setenv("NOTES", str(tmp_path / "notes"))
    monkeypatch.setattr(beside, "_PAUSE_S", 0.01)
    return Beside(tmp_path / "notes")


def test_counts_and_hints_travel_both_ways(service: Beside) -> None:
    service.worker.start()
    wait_until(lambda: service.counted('grader_gradings_total{verdict="crashed"} 1.0'))
    heard = service.doorbell.heard()
    service.doorbell.ring()
    wait_until(lambda: service.doorbell.heard() >= heard + 4)  # one of its own, three messages; no echo
    assert service.counted("grader_retries_total 2.0")
    assert service.counted("grader_given_up_total 1.0")
    service.worker.stop()
    assert service.said() == ["started", "told to stop"]
    assert service.doorbell.heard() == heard + 4


def test_a_worker_that_ends_is_replaced(
    service: Beside, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setenv("DIES", "1")
    service = Beside(service.notes)
    service.worker.start()
    wait_until(lambda: service.counted('grader_gradings_total{verdict="crashed"} 1.0'))
    service.worker.stop()
    assert service.said() == ["started", "started", "told to stop"]
    assert "the worker process ended (7)" in caplog.text


def test_a_worker_that_does_not_end_is_killed(
    service: Beside, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setenv("HANGS", "1")
    monkeypatch.setattr(beside, "_END_S", 0.1)
    service = Beside(service.notes)
    service.worker.start()
    wait_until(lambda: bool(service.said()))
    service.worker.stop()
    assert "does not end" in caplog.text
    process = service.worker._process
    assert process is not None
    assert process.returncode == -signal.SIGKILL


def test_a_worker_is_told_what_it_needs_and_no_secrets() -> None:
    secret = "3q9fKx72LmVb0pTzQQ"
    settings = Settings(
        database_url="sqlite:///x.db", slots=3, lease_s=9.5, assignments="a:b", metrics_token=secret
    )
    inherited = {
        "PATH": "/bin",
        "GRADER_MAIL_PASSWORD": secret,
        "GRADER_METRICS_PORT": "9",
        "GRADER_SLOTS": "7",
    }
    told = environment_of(settings, inherited)
    assert told["PATH"] == "/bin"
    assert (told["GRADER_SLOTS"], told["GRADER_LEASE_S"], told["GRADER_ASSIGNMENTS"]) == ("3", "9.5", "a:b")
    assert secret not in told.values()
    assert "GRADER_METRICS_PORT" not in told
    assert {f"GRADER_{name.upper()}" for name in Settings.model_fields} >= {
        name for name in told if name.startswith("GRADER_")
    }


def test_a_workers_end_of_the_link() -> None:
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    doorbell, gone = Doorbell(), threading.Event()
    link = ServiceLink(theirs.detach(), doorbell, gone)
    assert not os.get_inheritable(link._socket.fileno())
    link.graded(GradeStatus.GRADED, 0.5, 1.5)
    link.retried()
    link.given_up(2)
    doorbell.ring()
    said = [ours.recv(1000) for _ in range(4)]
    assert said == [b'["graded", "graded", 0.5, 1.5]', b'["retried", 1]', b'["given_up", 2]', b"\n"]
    heard = doorbell.heard()
    ours.send(b"\n")
    wait_until(lambda: doorbell.heard() == heard + 1)
    ours.close()
    assert gone.wait(60.0)
    link.retried()  # the service is gone: nothing happens
    link._socket.close()
