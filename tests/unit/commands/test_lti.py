"""`grader lti`, as typed: platforms of a course, and new keys that platforms can read before one signs."""

from collections.abc import Iterator

import pytest

from grader.commands import cli
from grader.outside.lti.scores import new_key
from grader.store.audit import AuditLog
from grader.store.clock import utc_now
from grader.store.courses import Courses
from grader.store.database import Database
from grader.store.platforms import Platforms

FIELDS = {
    "--title": "Moodle",
    "--issuer": "https://moodle.example",
    "--client-id": "c",
    "--deployment": "1",
    "--login-url": "https://moodle.example/auth",
    "--token-url": "https://moodle.example/token",
    "--keys-url": "https://moodle.example/keys",
}


@pytest.fixture
def database(sqlite_url: str, monkeypatch: pytest.MonkeyPatch) -> Iterator[Database]:
    monkeypatch.setenv("GRADER_DATABASE_URL", sqlite_url)
    opened = Database(sqlite_url)
    Courses(opened, utc_now).create("ros", "ROS", "UTC", "test")
    yield opened
    opened.close()


def typed(action: str, fields: dict[str, str]) -> list[str]:
    return ["lti", action, *(part for field in fields.items() for part in field), "--lang", "en"]


def test_a_platform_is_added_listed_and_removed(
    database: Database, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.run(typed("add", FIELDS)) == 0
    id_ = capsys.readouterr().out.strip()
    assert [one.id for one in Platforms(database, utc_now).of_course("ros")] == [id_]
    assert cli.run(typed("add", FIELDS)) == 2
    assert "a client ID is of one course" in capsys.readouterr().err
    assert cli.run(["lti", "list"]) == 0
    assert capsys.readouterr().out == f"{id_}\tMoodle\thttps://moodle.example\tc\t1\n"
    assert cli.run(["lti", "remove", id_]) == 0
    assert cli.run(["lti", "remove", id_, "--lang", "en"]) == 2
    assert "there is no such platform" in capsys.readouterr().err
    actions = [one.action for one in AuditLog(database).entries("ros", 2)]
    assert actions == ["platform.remove", "platform.add"]


def test_a_wrong_field_is_named(database: Database, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(typed("add", {**FIELDS, "--token-url": "http://moodle.example/token"})) == 2
    assert "--token-url" in capsys.readouterr().err
    assert Platforms(database, utc_now).of_course("ros") == ()


def test_a_key_that_others_know_is_gone_at_once(
    database: Database, capsys: pytest.CaptureFixture[str]
) -> None:
    platforms = Platforms(database, utc_now)
    (old,) = platforms.keys(new_key)
    assert cli.run(["lti", "rotate"]) == 0
    first, second = platforms.keys(new_key)
    assert (first, second == old) == (old, False)
    assert cli.run(["lti", "rotate", "--now"]) == 0
    (new,) = platforms.keys(new_key)
    assert new not in (old, second)
