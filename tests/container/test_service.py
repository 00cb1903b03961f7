"""The image as a service: start-up, health, a class graded, how it stops.

Once alone, by its own command, and once as compose.yaml starts it: an API process and two workers on PostgreSQL.
"""

import csv
import json
import re
import sqlite3
import subprocess
import time
from collections.abc import Iterator, Mapping
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path

import pytest
import yaml

from tests.container.running import SCRIPTS, good
from tests.fakes import postgres
from tools.image.runtime import Runtime

SERVICE, WORKERS = "service", ("worker-1", "worker-2")
SOCKETS = "/run/postgresql"
DATABASE = "image"
ABUSE = Path(__file__).parents[1] / "hostile" / "abuse"
COMPOSE = yaml.safe_load((Path(__file__).parents[2] / "compose.yaml").read_text(encoding="utf-8"))["services"]


@dataclass(frozen=True)
class Installation:
    """Containers that serve one course together.

    Attributes:
        environment: of all of them.
        shown: what all of them see of this host.
        running: containers by name.
    """

    runtime: Runtime
    environment: Mapping[str, str]
    shown: Mapping[str, Path]
    running: dict[str, "subprocess.Popen[bytes]"] = field(default_factory=dict)

    def start(self, name: str, arguments: list[str], environment: Mapping[str, str]) -> None:
        """Start a container; what all of them have in common comes before `environment`."""
        self.running[name] = self.runtime.start(
            name,
            arguments,
            environment={**environment, **self.environment},
            shown={**SCRIPTS, "/abuse": ABUSE, **self.shown},
        )

    def start_all(self, replicas: Mapping[str, tuple[str, ...]]) -> None:
        """Start the services of compose.yaml under the names of their replicas."""
        for service, names in replicas.items():
            for name in names:
                self.start(name, COMPOSE[service]["command"], COMPOSE[service]["environment"])

    def stop(self, signal: str) -> dict[str, tuple[int, str]]:
        """Send `signal` to all; return what each ended with and printed."""
        ends = {}
        while self.running:
            name, process = self.running.popitem()
            if process.poll() is None:
                self.runtime.signal(name, signal)
            ends[name] = (process.wait(timeout=60.0), self.runtime.printed(name))
        return ends


def create_course(installation: Installation) -> None:
    """Make a course as an instructor does: by a command of the image, from a file in its volume."""
    data = installation.runtime.folder / "data"
    (data / "class.csv").write_text("id,name\nada,Ada\nbo,小波\n", encoding="utf-8")
    command = ("course", "create", "ros2", "--instructor", "wang", "--roster", "class.csv")
    done = installation.runtime.run(*command, environment=installation.environment, shown=installation.shown)
    (data / "tokens.csv").write_text(good(done), encoding="utf-8")


def on_postgresql(runtime: Runtime, server: postgres.PostgresServer) -> Installation:
    """An installation whose database the containers reach by a socket of this host."""
    sockets = server.folder
    (sockets / ".s.PGSQL.5432").chmod(0o777)  # the image's user is not the server's
    sockets.chmod(0o755)
    server.create(DATABASE, empty=True)
    url = f"postgresql+psycopg://postgres@/{DATABASE}?host={SOCKETS}"
    return Installation(runtime, {"GRADER_DATABASE_URL": url}, {SOCKETS: sockets})


@pytest.fixture(scope="module", params=["alone", "workers"])
def installation(runtime: Runtime, request: pytest.FixtureRequest) -> Iterator[Installation]:
    """The image's own command; once alone, once beside two workers."""
    if request.param == "alone":
        made = Installation(runtime, {}, {})
    else:
        made = on_postgresql(runtime, request.getfixturevalue("postgres_server"))
    create_course(made)
    started = time.time()
    try:
        if request.param == "alone":
            made.start(SERVICE, runtime.image.config["Cmd"], {})
        else:
            made.start_all({"api": (SERVICE,), "worker": WORKERS})
        workers = str(max(len(made.running) - 1, 1))
        while runtime.execute(SERVICE, "python", "-c", "").returncode != 0:
            assert all(process.poll() is None for process in made.running.values()), "it ended at once"
        ready = float(good(runtime.execute(SERVICE, "python", "/scripts/await_service.py", workers)))
        print(f"\n{request.param}: start-up until /healthz says 200: {ready - started:.2f} s")
        yield made
    finally:
        for name, (_, printed) in made.stop("KILL").items():
            print(f"\n{name} printed:\n{printed}")


def test_the_health_checks_pass(runtime: Runtime, installation: Installation) -> None:
    checks = dict.fromkeys(WORKERS, COMPOSE["worker"]["healthcheck"]["test"])
    checks[SERVICE] = runtime.image.config["Healthcheck"]["Test"]
    for name in installation.running:
        kind, *command = checks[name]
        assert kind == "CMD"
        good(runtime.execute(name, *command))


def test_a_class_is_graded(runtime: Runtime, installation: Installation) -> None:
    text = good(runtime.execute(SERVICE, "python", "/scripts/hand_in.py"))
    rows = csv.DictReader(text.removeprefix("\ufeff").splitlines())
    points = {
        row["student"]: [row[f"{one} (100)"] for one in ("hello", "straight", "square")] for row in rows
    }
    assert points == {"ada": ["100", "100", "100"], "bo": ["0", "0", "67.65"]}


def test_a_backup_is_made_while_it_runs(runtime: Runtime, installation: Installation) -> None:
    good(runtime.execute(SERVICE, "grader", "db", "backup", "/data/backup.db"))
    with closing(sqlite3.connect(runtime.folder / "data" / "backup.db")) as backup:
        states = backup.execute("SELECT state, count(*) FROM submission GROUP BY state").fetchall()
    assert states == [("graded", 8)]


def test_attacks_count_and_cost_classmates_nothing(runtime: Runtime, installation: Installation) -> None:
    """With real limits of processes and memory, which `threads_held` and `memory_held` try to use up."""
    text = good(runtime.execute(SERVICE, "python", "/scripts/hostile_class.py"))
    print("\n" + text)
    *ends, cost = [json.loads(line) for line in text.splitlines()]
    good_ones = [one for one in ends if one["script"] == "good"]
    assert [(one["score"], one["tries"]) for one in good_ones] == [(100, 1)] * len(good_ones)
    bad_ones = {one["script"]: one for one in ends if one["script"] != "good"}
    assert bad_ones.keys() == {path.stem for path in ABUSE.glob("*.py")}
    for name, one in bad_ones.items():
        expected = re.search(r"^Expected: (.+)$", (ABUSE / f"{name}.py").read_text(), re.MULTILINE)
        assert expected is not None
        assert (one["status"], one["tries"] <= 2) == ("graded", True), one
        assert one["verdict"] in expected[1].replace("finished", "graded").split(" or "), one
        # this one drives a square for its points; what it is after is an attempt that does not count
        assert one["score"] < 50 or name == "square_then_syntax_error", one
    assert cost == {"attempts": len(bad_ones)}


def test_it_stops_in_good_order(installation: Installation) -> None:
    names = set(installation.running)
    ends = installation.stop("TERM")
    assert {name: code for name, (code, _) in ends.items()} == dict.fromkeys(names, 0), ends
    assert all("Traceback" not in printed for _, printed in ends.values()), ends
