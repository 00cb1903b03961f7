"""The image's own command: start-up, a class graded over HTTP, health, and how it stops."""

import csv
import subprocess
import time
from collections.abc import Iterator

import pytest

from tests.container.running import SCRIPTS, good
from tools.image.runtime import Runtime

NAME = "service"


@pytest.fixture(scope="module")
def service(runtime: Runtime) -> Iterator["subprocess.Popen[str]"]:
    """`docker run` of the image as it is, after a course was made in its volume."""
    data = runtime.folder / "data"
    (data / "class.csv").write_text("id,name\nada,Ada\nbo,小波\n", encoding="utf-8")
    tokens = good(runtime.run("course", "create", "ros2", "--instructor", "wang", "--roster", "class.csv"))
    (data / "tokens.csv").write_text(tokens, encoding="utf-8")
    started = time.time()
    process = runtime.start(NAME, runtime.image.config["Cmd"], SCRIPTS)
    try:
        while runtime.execute(NAME, "python", "-c", "").returncode != 0:
            assert process.poll() is None, "it ended at once"
        ready = float(good(runtime.execute(NAME, "python", "/scripts/await_service.py")))
        print(f"\nstart-up until /healthz says 200: {ready - started:.2f} s")
        yield process
    finally:
        if process.poll() is None:
            runtime.signal(NAME, "KILL")
        process.communicate()


def test_the_health_check_of_the_image_passes(runtime: Runtime, service: "subprocess.Popen[str]") -> None:
    kind, *command = runtime.image.config["Healthcheck"]["Test"]
    assert kind == "CMD"
    good(runtime.execute(NAME, *command))


def test_a_class_is_graded(runtime: Runtime, service: "subprocess.Popen[str]") -> None:
    text = good(runtime.execute(NAME, "python", "/scripts/hand_in.py"))
    print(f"\n{text}")
    rows = csv.DictReader(text.removeprefix("\ufeff").splitlines())
    points = {
        row["student"]: [row[f"{one} (100)"] for one in ("hello", "straight", "square")] for row in rows
    }
    assert points == {"ada": ["100", "100", "100"], "bo": ["0", "0", "77.5"]}


def test_it_stops_in_good_order(runtime: Runtime, service: "subprocess.Popen[str]") -> None:
    runtime.signal(NAME, "TERM")
    printed, _ = service.communicate(timeout=60.0)
    assert service.returncode == 0, printed
    assert "Traceback" not in printed
