"""`grader demo`: a small class over HTTP, from upload to dashboard."""

import argparse
import os
import secrets
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import httpx
from rich.console import Console
from rich.progress import Progress

from grader.catalog import Catalog
from grader.commands.options import add_language_option
from grader.contracts.errors import InfrastructureError
from grader.render.dashboard import render_dashboard
from grader.render.labels import word
from grader.render.terminal import console

_START_S = 300.0  # a machine that is busy with something else
_STANDSTILL_S = 300.0  # however slow the machine, some grading ends within it
_LOWEST_PORT, _PORTS = 20_000, 10_000  # Linux picks ports for outgoing connections from 32 768 on
_NO_IDLE_CONNECTIONS = httpx.Limits(max_keepalive_connections=0)
"""The server may close an idle connection at the moment the next request is sent on it."""
_OPEN_STATES = ("queued", "running")


@dataclass(frozen=True, slots=True)
class DemoUpload:
    """One file that a student of the demo hands in."""

    student: str
    assignment: str
    file: str
    source: bytes


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument(
        "--output",
        type=Path,
        default=Path("demo-output"),
        help="folder for plots and database (demo-output) / 存放轨迹图和数据库的文件夹",
    )
    add_language_option(parser)


def run(arguments: argparse.Namespace) -> int:
    """Start a server, let a class hand in its work, show the dashboard and save the plots."""
    output = console()
    plots = arguments.output / "plots"
    plots.mkdir(parents=True, exist_ok=True)
    uploads = list(_uploads_of_the_class())
    with serving(arguments.output) as client:
        start = time.monotonic()
        locations = [hand_in(client, upload) for upload in uploads]
        await_grades(client, locations, output)
        spent_s = time.monotonic() - start
        output.print(word("demo_graded", arguments.lang, count=len(uploads), seconds=f"{spent_s:.1f}"))
        for upload, location in zip(uploads, locations, strict=True):
            _save_plots(
                client,
                location,
                plots / f"{upload.student}-{upload.assignment}-{Path(upload.file).stem}",
                arguments.lang,
            )
        query = {"lang": arguments.lang}
        dashboard = client.get("/api/v1/dashboard", params=query).raise_for_status().json()
    output.print(render_dashboard(dashboard, language=arguments.lang))
    output.print(word("demo_plots", arguments.lang, plots=plots), soft_wrap=True)
    pages = word("demo_pages", arguments.lang, program=_program(), data=arguments.output)
    output.print(pages, soft_wrap=True)
    return 0


def _program() -> str:
    """Return the command to type for the grader; installed by `make`, it is not on the PATH."""
    beside = Path(sys.executable).with_name("grader")
    return "grader" if shutil.which("grader") else os.path.relpath(beside)


def _save_plots(client: httpx.Client, location: str, stem: Path, language: str) -> None:
    """Save a picture of each run. A text is not run, so it has none."""
    runs = client.get(location).raise_for_status().json()["runs"]
    for run in runs:
        query = {"lang": language, "case": run["case"]}
        plot = client.get(f"{location}/plot.png", params=query).raise_for_status()
        name = stem.name if len(runs) == 1 else f"{stem.name}-{run['case']}"
        stem.with_name(f"{name}.png").write_bytes(plot.content)


def _uploads_of_the_class() -> Iterator[DemoUpload]:
    """Yield the lesson's scripts, every solution, and some wrong scripts."""
    catalog = Catalog()
    lesson = catalog.lesson()
    if lesson is not None:
        for name, file in (
            ("hello", "hello_node"),
            ("straight", "straight_mover"),
            ("square", "square_mover"),
        ):
            yield DemoUpload("lesson", name, f"{file}.py", (lesson / f"{file}.py").read_bytes())
    for assignment in catalog.all():
        (solution, right), _, *wrong = catalog.scripts(assignment.id).items()
        yield DemoUpload("ada", assignment.id, solution, right)
        for student, (path, source) in zip(("bo", "chen", "dai"), wrong, strict=False):
            yield DemoUpload(student, assignment.id, path.removeprefix("wrong/"), source)
        yield DemoUpload("chen", assignment.id, solution, right)


@contextmanager
def serving(output: Path) -> Iterator[httpx.Client]:
    """Run `grader serve` on a free port with an empty database; yield a client with the instructor's token."""
    for old in output.glob("grader.db*"):
        old.unlink()
    port = _free_port()
    token = secrets.token_urlsafe(24)
    command = [sys.executable, "-m", "grader", "serve", "--port", str(port), "--data", str(output)]
    environment = {"GRADER_LOG_LEVEL": "warning", **os.environ, "GRADER_INSTRUCTOR_TOKEN": token}
    server = subprocess.Popen(command, env=environment)
    headers = {"Authorization": f"Bearer {token}"}
    try:
        with httpx.Client(
            base_url=f"http://127.0.0.1:{port}",
            headers=headers,
            timeout=60.0,
            trust_env=False,
            limits=_NO_IDLE_CONNECTIONS,
        ) as client:
            _await_start(client, server)
            yield client
    finally:
        server.terminate()
        server.wait()


def _free_port() -> int:
    """Return a free port that the system does not take for an outgoing connection meanwhile."""
    while True:
        port = _LOWEST_PORT + secrets.randbelow(_PORTS)
        with socket.socket() as probe, suppress(OSError):
            probe.bind(("127.0.0.1", port))
            return port


def _await_start(client: httpx.Client, server: subprocess.Popen[bytes]) -> None:
    deadline = time.monotonic() + _START_S
    while time.monotonic() < deadline:
        if server.poll() is not None:
            raise InfrastructureError(f"the server ended at once (exit code {server.returncode})")
        try:
            if client.get("/healthz").is_success:
                return
        except httpx.TransportError:
            pass
        time.sleep(0.1)
    raise InfrastructureError(f"the server was not ready within {_START_S:g} s")


def hand_in(client: httpx.Client, upload: DemoUpload) -> str:
    """Upload one file, as soon as the service takes it; return where its submission is found.

    One student may have a number of submissions open at a time: where grading is slower than uploading, the
    service answers 429 and says when to come again.
    """
    deadline = time.monotonic() + _STANDSTILL_S
    while True:
        response = client.post(
            "/api/v1/submissions",
            data={"student": upload.student, "assignment": upload.assignment},
            files={"file": (upload.file, upload.source, "text/x-python")},
        )
        if response.status_code != httpx.codes.TOO_MANY_REQUESTS or time.monotonic() > deadline:
            break
        time.sleep(int(response.headers["Retry-After"]))
    if response.status_code != httpx.codes.ACCEPTED:
        raise InfrastructureError(f"{upload.file} was refused: {response.text}")
    return str(response.headers["Location"])


def await_grades(client: httpx.Client, locations: list[str], output: Console) -> None:
    """Wait, showing progress, until every submission has been graded; as long as there is progress."""
    waiting = set(locations)
    deadline = time.monotonic() + _STANDSTILL_S
    with Progress(console=output, transient=True) as progress:
        task = progress.add_task("grading", total=len(waiting))
        while waiting:
            if time.monotonic() > deadline:
                raise InfrastructureError(
                    f"{len(waiting)} submissions wait, and none was graded within {_STANDSTILL_S:g} s"
                )
            for location in sorted(waiting):
                if client.get(location).raise_for_status().json()["status"] not in _OPEN_STATES:
                    waiting.discard(location)
                    progress.advance(task)
                    deadline = time.monotonic() + _STANDSTILL_S
            time.sleep(0.1)
