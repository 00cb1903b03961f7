from pathlib import Path
from typing import Literal, get_args, get_origin

import pytest
from annotated_types import Ge, Gt, Le
from pydantic.fields import FieldInfo

from grader.contracts.errors import SettingsError
from grader.operation.settings import Settings, is_loopback, load
from grader.store.clock import LONGEST_PAUSE


@pytest.fixture(autouse=True)
def _clean_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("DATABASE_URL", *(f"GRADER_{field.upper()}" for field in Settings.model_fields)):
        monkeypatch.delenv(name, raising=False)


def test_the_defaults_are_safe() -> None:
    settings = load()
    assert is_loopback(settings.host)
    assert settings.max_upload_bytes == 256 * 1024
    assert settings.instructor_token is None
    assert settings.slots >= 1


def test_every_setting_is_described() -> None:
    assert [name for name, field in Settings.model_fields.items() if not field.description] == []


def test_no_number_is_endless() -> None:
    bounds = {
        name: [one for one in field.metadata if isinstance(one, Ge | Gt | Le)]
        for name, field in Settings.model_fields.items()
        if field.annotation in (int, float, int | None)
    }
    assert len(bounds) > 20
    assert {name: found for name, found in bounds.items() if len(found) != 2} == {}


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.168.1.5", "grader.example.org", "127.0.0.1.evil.org"])
def test_other_machines_reach_more_than_loopback(host: str) -> None:
    assert not is_loopback(host)


@pytest.mark.parametrize("host", ["127.0.0.1", "127.8.8.8", "::1", "[::1]", "localhost"])
def test_loopback(host: str) -> None:
    assert is_loopback(host)


@pytest.mark.parametrize(
    ("url", "why"),
    [
        ("sqlite://", "memory"),
        ("sqlite:///:memory:", "memory"),
        ("sqlite:///file:x?mode=memory&uri=true", "memory"),
        ("mysql://localhost/x", "mysql"),
        ("nonsense", "not a database URL"),
        ("postgresql://grader:pa@ss@host/grader", "%40"),
        ("postgresql+psycopg://host", "name the database"),
        ("postgresql+asyncpg://host/grader", "not postgresql\\+asyncpg"),
    ],
)
def test_a_database_that_forgets_or_is_unknown_is_refused(url: str, why: str) -> None:
    with pytest.raises(SettingsError, match=why) as caught:
        load(database_url=url)
    assert "ss@host" not in str(caught.value)


@pytest.mark.parametrize("scheme", ["postgresql+psycopg", "postgresql", "postgres"])
def test_a_postgresql_database_is_accepted_and_its_password_does_not_show(scheme: str) -> None:
    settings = load(database_url=f"{scheme}://grader:3q9fKx72@db:5432/grader?sslmode=require")
    assert settings.database_url == "postgresql+psycopg://grader:3q9fKx72@db:5432/grader?sslmode=require"
    assert "3q9fKx72" not in repr(settings)


def test_the_graders_own_variable_goes_before_the_common_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("DATABASE_URL", "postgresql://db/grader")
    assert load().database_url == "postgresql+psycopg://db/grader"
    monkeypatch.setenv("GRADER_DATABASE_URL", "sqlite:////var/lib/grader.db")
    assert load().database_url == "sqlite:////var/lib/grader.db"
    assert load(database_url="sqlite:////mine.db").database_url == "sqlite:////mine.db"


@pytest.mark.parametrize(
    "token", ["short", "a" * 40, "abcdefgh ijklmnopq", "令牌令牌令牌一二三四五六七八九十"]
)
def test_a_weak_token_is_refused_and_not_repeated(token: str) -> None:
    with pytest.raises(SettingsError, match="instructor_token") as caught:
        load(instructor_token=token)
    assert token not in str(caught.value)


def test_a_token_does_not_show_in_the_settings() -> None:
    token = "3q9fKx72LmVb0pTz"
    assert token not in repr(load(instructor_token=token))


def test_a_heartbeat_slower_than_the_lease_allows_is_refused() -> None:
    with pytest.raises(SettingsError, match="a third"):
        load(lease_s=6.0, heartbeat_s=3.0)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("max_tries", 0),
        ("max_tries", 10**30),
        ("poll_s", float("inf")),
        ("drain_s", float("inf")),
        ("lease_s", float("nan")),
        ("lease_s", LONGEST_PAUSE.total_seconds()),
        ("slots", -1),
        ("database_connections", 2),
    ],
)
def test_values_out_of_range_are_refused_by_name(field: str, value: float) -> None:
    with pytest.raises(SettingsError, match=field):
        load(**{field: value})


@pytest.mark.parametrize(
    ("field", "value", "en", "zh"),
    [
        ("slots", -1, "slots (GRADER_SLOTS): Use 0 or more.", "slots (GRADER_SLOTS)：不能小于 0。"),
        ("lease_s", 0, "lease_s (GRADER_LEASE_S): Use more than 0.", "lease_s (GRADER_LEASE_S)：要大于 0。"),
        ("database_url", "sqlite://", "must name a file", "必须是文件"),
        ("heartbeat_s", 9.0, "heartbeat_s 9 must be at most a third", "heartbeat_s 9 不能超过"),
    ],
)
def test_a_refusal_names_the_variable_in_both_languages(field: str, value: object, en: str, zh: str) -> None:
    with pytest.raises(SettingsError) as caught:
        load(**{field: value})
    assert en in caught.value.message_in("en")
    assert zh in caught.value.message_in("zh")


def test_the_environment_is_read(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GRADER_PORT", "9000")
    monkeypatch.setenv("DATABASE_URL", "sqlite:////var/lib/grader.db")
    settings = load()
    assert (settings.port, settings.database_url) == (9000, "sqlite:////var/lib/grader.db")
    assert load(port=1).port == 1


@pytest.mark.parametrize(
    ("name", "meant"), [("GRADER_SLOT", "GRADER_SLOTS"), ("GRADER_LEASE", "GRADER_LEASE_S")]
)
def test_a_misspelt_variable_is_refused(monkeypatch: pytest.MonkeyPatch, name: str, meant: str) -> None:
    monkeypatch.setenv(name, "3")
    with pytest.raises(SettingsError, match=f"{name}: .* is it {meant}\\?"):
        load()


@pytest.mark.parametrize(
    "name",
    ["GRADER_ASSIGNMENT", "GRADER_TOKEN", "GRADER_PORT_8080_TCP", "GRADER_DB_PORT", "GRADER_DATABASE_USER"],
)
def test_variables_of_others_are_left_alone(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    monkeypatch.setenv("GRADER_DATABASE_URL", "sqlite:///grader.db")  # so that it is no other's misspelt name
    monkeypatch.setenv(name, "tcp://10.0.0.1:8080")
    assert load().port == 8080


def accepted(field: FieldInfo) -> str:
    """Return which values a setting takes, as the service page writes it; empty: its description says so."""
    if field.annotation is bool:
        return "`true`, `false`"
    if get_origin(field.annotation) is Literal:
        return ", ".join(f"`{value}`" for value in get_args(field.annotation))
    least = [f"{one.ge:g}" for one in field.metadata if isinstance(one, Ge)]
    above = [f"more than {one.gt:g}" for one in field.metadata if isinstance(one, Gt)]
    most = [f"{one.le:.10g}" for one in field.metadata if isinstance(one, Le)]
    if least and most:
        return " to ".join(least + most)
    return ", ".join([*above, *(f"{one} or more" for one in least), *(f"at most {one}" for one in most)])


def test_the_operators_guide_lists_every_setting_as_it_is() -> None:
    page = (Path(__file__).resolve().parents[3] / "docs" / "operator.md").read_text()
    lines = [line for line in page.splitlines() if line.startswith("| `GRADER_")]
    rows = [[cell.strip() for cell in line.strip()[1:-1].split("|")] for line in lines]
    listed = {name: (default, values, meaning) for name, default, values, meaning in rows}
    for name, field in Settings.model_fields.items():
        default, values, meaning = listed.pop(f"`GRADER_{name.upper()}`")
        assert (values, meaning) == (accepted(field), field.description)
        if field.default not in (None, "") and field.default_factory is None:
            assert default == f"`{'false' if field.default is False else field.default}`"
    assert listed == {}
