"""compose.yaml names what exists, says what the parts of the service accept, and gives nothing away."""

import argparse
import importlib
import re
from pathlib import Path
from typing import Any

import pytest
import yaml

from grader.commands.cli import COMMANDS
from grader.contracts.assignment import MIB, Limits
from grader.operation.settings import Settings, load
from tests.fakes import postgres

ROOT = Path(__file__).resolve().parents[2]
TEXT = (ROOT / "compose.yaml").read_text(encoding="utf-8")
COMPOSE: dict[str, Any] = yaml.safe_load(TEXT)
SERVICES: dict[str, dict[str, Any]] = COMPOSE["services"]
OURS = ("api", "worker")
SHARED_MAPPINGS = 384 * MIB  # docs/sandbox.md: what a script may take beyond its limit
GRADING_PROCESS = 150 * MIB
SERVICE, LIVE_CAR = 300 * MIB, 60 * MIB
UNITS = {"m": MIB, "g": 1024 * MIB}


def seconds(duration: str) -> float:
    match = re.fullmatch(r"(\d+)s", duration)
    assert match, duration
    return float(match[1])


def size(text: str) -> int:
    return int(text[:-1]) * UNITS[text[-1]]


def test_it_is_compose() -> None:
    compose_spec = pytest.importorskip("compose_spec")
    options = compose_spec.PyOptions()
    options.apply_merge = True
    assert set(options.from_yaml(TEXT).service_names()) == {"api", "worker", "db"}


def test_one_service_two_workers_one_database() -> None:
    assert set(SERVICES) == {"api", "worker", "db"}
    assert SERVICES["worker"]["deploy"]["replicas"] == 2
    assert {SERVICES[name]["image"] for name in OURS} == {"grader"}
    assert (ROOT / SERVICES["api"]["build"] / "Dockerfile").is_file()


@pytest.mark.parametrize("name", OURS)
def test_commands_are_the_graders(name: str) -> None:
    command, *arguments = SERVICES[name]["command"]
    assert command in COMMANDS
    parser = argparse.ArgumentParser(exit_on_error=False)
    importlib.import_module(f"grader.commands.{command}").configure(parser)
    parser.parse_args(arguments)


@pytest.mark.parametrize("name", OURS)
def test_settings_are_accepted(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    environment = SERVICES[name]["environment"]
    own = {key: value for key, value in environment.items() if key.startswith("GRADER_")}
    assert {key.removeprefix("GRADER_").lower() for key in own} <= set(Settings.model_fields)
    for key, value in own.items():
        monkeypatch.setenv(key, value)
    settings = load()
    assert settings.slots == (0 if name == "api" else 2)
    assert f"@{settings.database_url.split('@')[1].split('/')[0]}" == "@db"
    assert settings.drain_s < seconds(SERVICES[name]["stop_grace_period"])
    assert set(environment) == {*own, "PGPASSWORD"}


def test_the_database_is_the_one_the_service_asks_for() -> None:
    environment, url = SERVICES["db"]["environment"], SERVICES["api"]["environment"]["GRADER_DATABASE_URL"]
    assert url == f"postgresql+psycopg://{environment['POSTGRES_USER']}@db/{environment['POSTGRES_DB']}"
    assert environment["POSTGRES_PASSWORD"] == SERVICES["api"]["environment"]["PGPASSWORD"]


def test_the_database_is_of_the_version_that_the_tests_use(postgres_server: postgres.PostgresServer) -> None:
    with postgres_server.connected("postgres") as connection:
        version = connection.execute("SHOW server_version").fetchone()[0]
    assert SERVICES["db"]["image"] == f"postgres:{version.split('.')[0]}-bookworm"


@pytest.mark.parametrize("name", SERVICES)
def test_every_container_is_held_tight(name: str) -> None:
    service = SERVICES[name]
    assert service["read_only"] is True
    assert service["cap_drop"] == ["ALL"]
    assert service["security_opt"] == ["no-new-privileges:true"]  # and so the engine's default filter
    assert service["restart"] == "unless-stopped"
    assert set(service["deploy"]["resources"]["limits"]) == {"cpus", "memory", "pids"}
    assert not {"privileged", "cap_add", "devices", "pid", "ipc", "network_mode", "userns_mode"} & set(
        service
    )
    assert all(not volume.startswith((".", "/", "~")) for volume in service.get("volumes", ()))
    assert any(one.startswith("/tmp:") for one in service["tmpfs"])


def test_a_worker_has_room_for_its_scripts() -> None:
    worker = SERVICES["worker"]
    slots = int(worker["environment"]["GRADER_SLOTS"])
    needed = slots * (Limits().memory_bytes + SHARED_MAPPINGS + GRADING_PROCESS)
    assert size(worker["deploy"]["resources"]["limits"]["memory"]) >= needed


def test_the_service_has_room_for_practice_and_live_cars() -> None:
    """Else a script that is only practised ends the service, or everybody's cars."""
    settings = Settings()
    script = Limits().memory_bytes + SHARED_MAPPINGS + GRADING_PROCESS
    needed = SERVICE + settings.practice_runs * script + settings.live_cars * LIVE_CAR
    assert size(SERVICES["api"]["deploy"]["resources"]["limits"]["memory"]) >= needed


def test_only_the_service_is_reached_and_only_from_this_machine() -> None:
    assert {name for name in SERVICES if "ports" in SERVICES[name]} == {"api"}
    assert all(port.startswith("127.0.0.1:") for port in SERVICES["api"]["ports"])
    assert COMPOSE["networks"]["database"]["internal"] is True
    assert SERVICES["worker"]["networks"] == SERVICES["db"]["networks"] == ["database"]


def test_what_it_refers_to_is_there() -> None:
    for service in SERVICES.values():
        assert set(service["networks"]) <= set(COMPOSE["networks"])
        assert {volume.split(":")[0] for volume in service.get("volumes", ())} <= set(COMPOSE["volumes"])
        assert set(service.get("depends_on", ())) <= set(SERVICES)
        assert all("healthcheck" in SERVICES[other] for other in service.get("depends_on", ()))


def test_secrets_come_from_a_file_that_is_not_kept() -> None:
    assert set(re.findall(r"\$\{(\w+)", TEXT)) == {"POSTGRES_PASSWORD"}
    assert "/.env" in (ROOT / ".gitignore").read_text(encoding="utf-8").splitlines()
    assert (ROOT / ".dockerignore").read_text(encoding="utf-8").splitlines()[1] == "*"


def test_the_dockerfile_names_no_package_index_and_only_files_that_exist() -> None:
    text = (ROOT / "Dockerfile").read_text(encoding="utf-8")
    assert set(re.findall(r"://([^/:'\"]+)", text)) == {"127.0.0.1"}  # the health check's
    copied = [
        word for line in re.findall(r"^COPY (?!--from)(.+) \S+$", text, re.MULTILINE) for word in line.split()
    ]
    assert "requirements-extras.lock" in copied
    assert all((ROOT / name).exists() for name in copied)
