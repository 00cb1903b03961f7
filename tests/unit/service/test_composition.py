"""How the service is put together, without its workers."""

import logging
from pathlib import Path

import pytest

from grader.catalog import Catalog
from grader.catalog.authoring import create
from grader.contracts.errors import SandboxUnavailableError, SettingsError
from grader.contracts.identity import OPERATOR
from grader.operation.settings import Settings
from grader.service import composition
from tests.fakes.grading import FakePreflight


def settings(url: str, **changes: object) -> Settings:
    return Settings(database_url=url, slots=0, **changes)


def told(capsys: pytest.CaptureFixture[str]) -> list[str]:
    return [line.split()[-1] for line in capsys.readouterr().err.splitlines() if "instructor token" in line]


def test_a_token_is_made_and_told_at_each_start(
    database_url: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with composition.running(settings(database_url), FakePreflight()) as services:
        (token,) = told(capsys)
        assert len(token) >= 32
        assert services.callers.identify(token) is OPERATOR
        assert services.callers.identify(token[:-1]) is None
    with composition.running(settings(database_url), FakePreflight()):
        (other,) = told(capsys)
        assert other != token


def test_the_operators_token_is_not_told(database_url: str, capsys: pytest.CaptureFixture[str]) -> None:
    mine = settings(database_url, instructor_token="3q9fKx72LmVb0pTzQQ")
    with composition.running(mine, FakePreflight()) as services:
        assert services.callers.identify("3q9fKx72LmVb0pTzQQ") is OPERATOR
    assert told(capsys) == []


def test_a_host_without_a_sandbox_takes_uploads_and_says_so(
    database_url: str, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def refuse(_: object) -> None:
        raise SandboxUnavailableError("this host lacks seccomp")

    monkeypatch.setattr(composition, "syntax_sandbox", refuse)
    with caplog.at_level(logging.ERROR), composition.running(settings(database_url)) as services:
        assert services.preflight.check(b"def broken(", "a.py") is None
    assert "lacks seccomp" in caplog.text


def test_own_assignments_live_in_a_folder_of_their_own(database_url: str, tmp_path: Path) -> None:
    for name in ("mine", "broken"):
        folder = create(Catalog(tmp_path), name)
        if name == "broken":
            spec = folder / "assignment.yaml"
            spec.write_text(spec.read_text().replace("sides: 4", "sides: 4, colour: [1, 2]"))
    own = settings(database_url, assignments=str(tmp_path))
    with composition.running(own, FakePreflight()) as services:
        ids = {one.id for one in services.assignments.of(None).all()}
        assert {"square", "mine"} <= ids
        assert "broken" not in ids
        (trouble,) = services.assignments.of(None).troubles().values()
    assert "options.colour: the check 'polygon' has only the options" in trouble.en


def test_leaving_this_machine_needs_a_course_or_consent(database_url: str) -> None:
    network = settings(database_url, host="0.0.0.0")
    with (
        pytest.raises(SettingsError, match=r"course create.*ALLOW_ANONYMOUS_NETWORK"),
        composition.running(network, FakePreflight()),
    ):
        pass
    with composition.running(settings(database_url), FakePreflight()) as services:
        services.courses.create("ros", "ROS", "UTC", "test")
    with composition.running(network, FakePreflight()) as services:
        assert services.courses.exist()


def test_consent_suffices(database_url: str) -> None:
    network = settings(database_url, host="0.0.0.0", allow_anonymous_network=True)
    with composition.running(network, FakePreflight()) as services:
        assert not services.courses.exist()


def test_with_a_course_no_token_is_made(database_url: str, capsys: pytest.CaptureFixture[str]) -> None:
    with composition.running(settings(database_url), FakePreflight()) as services:
        services.courses.create("ros", "ROS", "UTC", "test")
        assert len(told(capsys)) == 1
    with composition.running(settings(database_url), FakePreflight()):
        assert told(capsys) == []
