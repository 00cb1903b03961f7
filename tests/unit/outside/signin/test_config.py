from pathlib import Path

import pytest

from grader.contracts.errors import SettingsError
from grader.outside.signin import read_config
from grader.outside.signin.opening import opened

GOOD = """
public_url = "https://grader.example.edu/"
[[providers]]
kind = "oidc"
id = "campus"
title = "统一身份认证"
issuer = "https://sso.example.edu"
client_id = "grader"
client_secret = "s"
[[providers]]
kind = "cas"
id = "cas"
title = "CAS"
url = "https://cas.example.edu/cas/"
[[providers]]
kind = "header"
id = "proxy"
title = "Proxy"
header = "X-Remote-User"
proxies = ["10.0.0.5", "10.1.0.0/16"]
"""


def test_the_file_is_read(tmp_path: Path) -> None:
    path = tmp_path / "signin.toml"
    path.write_text(GOOD, "utf-8")
    providers = opened(read_config(path), lambda: 0.0)
    assert [one.id for one in providers] == ["campus", "cas", "proxy"]
    assert providers.public_url == "https://grader.example.edu"


@pytest.mark.parametrize(
    ("before", "after", "told"),
    [
        ('issuer = "https:', 'issuer = "http:', "issuer"),
        ('url = "https://cas', 'url = "ftp://cas', "url"),
        ('issuer = "https://sso', 'issuer = "https://a:b@sso', "issuer"),
        ('id = "cas"', 'id = "campus"', "campus"),
        ('id = "cas"', 'id = "Campus 1"', "providers.1.cas.id"),
        ('"10.0.0.5"', '"0.0.0.0/0"', "proxies"),
        ('"10.0.0.5"', '"proxy.example"', "proxies"),
        ("grader.example.edu/", "grader.example.edu/sub", "public_url"),
        ('client_secret = "s"', 'client_secrets = "s"', "client_secrets"),
        ('client_secret = "s"', 'client_secret_file = "/nowhere/secret"', "/nowhere/secret"),
        ('kind = "cas"', 'kind = "saml"', "providers.1: 'kind': use one of 'oidc', 'cas', 'header'"),
        ('kind = "cas"', "", "providers.1: 'kind' is missing"),
        ('id = "cas"', 'ids = "cas"', "providers.1.cas.ids: There is no such field"),
        ('id = "cas"', 'ids = "cas"', "providers.1.cas.id: This field is missing"),
        ("[[providers]]", "[[providers]", "TOML"),
    ],
)
def test_what_is_wrong_is_named(tmp_path: Path, before: str, after: str, told: str) -> None:
    path = tmp_path / "signin.toml"
    path.write_text(GOOD.replace(before, after, 1), "utf-8")
    with pytest.raises(SettingsError, match="signin") as raised:
        opened(read_config(path), lambda: 0.0)
    assert told in str(raised.value)
    assert "error" not in str(raised.value).lower()  # the words are ours
    assert any("\u4e00" <= sign <= "\u9fff" for sign in raised.value.zh.replace("统一身份认证", ""))


def test_a_missing_or_endless_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match="GRADER_SIGNIN"):
        read_config(tmp_path / "none.toml")
    path = tmp_path / "long.toml"
    path.write_text("#" * 70_000)
    with pytest.raises(SettingsError, match="64 KiB"):
        read_config(path)
