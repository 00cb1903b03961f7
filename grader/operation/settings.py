"""What an operator can set: environment variables ``GRADER_...``, each with a safe default.

`load` is the only way in: it turns every refusal into one readable `SettingsError`.
"""

import difflib
import ipaddress
import os
import re
from pathlib import Path
from typing import Annotated, Any, Literal
from urllib.parse import urlsplit

from pydantic import AliasChoices, Field, SecretStr, ValidationError, field_validator, model_validator
from pydantic_settings import BaseSettings, SettingsConfigDict
from sqlalchemy import make_url
from sqlalchemy.exc import ArgumentError

from grader.contracts.errors import SettingsError
from grader.contracts.python import Self
from grader.contracts.text import Language
from grader.contracts.validation_words import said

LogFormat = Literal["text", "json"]
LogLevel = Literal["debug", "info", "warning", "error"]
Count = Annotated[int, Field(ge=1, le=1_000_000)]  # neither databases nor floats take any number

_PREFIX = "GRADER_"
_OF_PRAIRIELEARN = "GRADER_ASSIGNMENT"  # no setting of the service
_ALIKE = 0.9  # one wrong letter leaves more of any name; engines of containers set others, as GRADER_DB_PORT
_SHORTEST_TOKEN = 16
_RENEWALS_PER_LEASE = 3
_SILENT_BEATS = 4
_MAX_UPLOAD_BYTES = 4 * 1024 * 1024
_MAIL_ADDRESS = re.compile(r"[A-Za-z0-9!#$%&'*+/=?^_`{|}~.-]+@[A-Za-z0-9.-]+")
_POSTGRESQL = "postgresql+psycopg"


class Settings(BaseSettings):
    """Settings of the service and its workers. Frozen; unsafe combinations are refused."""

    model_config = SettingsConfigDict(
        env_prefix=_PREFIX, frozen=True, extra="forbid", hide_input_in_errors=True
    )

    host: str = Field(default="127.0.0.1", description="Address the service listens on.")
    port: int = Field(default=8080, ge=0, le=65_535, description="Port it listens on; 0 takes a free one.")
    allow_anonymous_network: bool = Field(
        default=False,
        description="Listen beyond this machine although there is no course and nobody is asked who they are: "
        "anybody who reaches the port can upload under any name. Put a proxy that authenticates in front.",
    )
    database_url: str = Field(
        default="sqlite:///grader.db",
        validation_alias=AliasChoices(_PREFIX + "DATABASE_URL", "database_url"),
        repr=False,  # it may hold a password
        description="Where submissions are kept: a SQLite file, or a PostgreSQL database "
        "(`postgresql+psycopg://user@host/name`). `DATABASE_URL` is read, too, when this is not set.",
    )
    database_connections: int = Field(
        default=10,
        ge=3,
        le=200,
        description="Most connections of this process to PostgreSQL, besides those that wait for work; requests "
        "beyond that wait for one.",
    )
    instructor_token: SecretStr | None = Field(
        default=None,
        description="Token that opens the class while there is no course, at least 16 characters; without it, "
        "one is made and printed at each start.",
    )
    signin: Path | None = Field(
        default=None,
        description="File that says who recognises people besides their tokens: a university's OpenID Connect or "
        "CAS, or a proxy; `docs/signin.md` describes it.",
    )
    mail_server: str = Field(
        default="",
        description="Server that e-mail of courses goes through: `smtps://mail.example.edu` (port 465), or "
        "`smtp://mail.example.edu` (port 587; STARTTLS, except on this machine). Without it none is sent.",
    )
    mail_user: str = Field(default="", description="Name by which that server lets the service in.")
    mail_password: SecretStr | None = Field(default=None, description="Password for that name.")
    mail_from: str = Field(
        default="", description="Address that e-mail comes from, such as `grader@example.edu`."
    )
    default_language: Language = Field(
        default="zh",
        description="Language of answers when a request asks for neither zh nor en, "
        "and of commands without `--lang`.",
    )
    assignments: str = Field(
        default="",
        description="Folders of assignments of one's own, besides those that come with the grader; several are "
        "separated by `:`. `robot` is the set of exercises with a robot, `pybullet` that of PyBullet "
        "scripts; both come with the grader. "
        "A file that is wrong disables its own assignment only, and the service page says so.",
    )
    max_upload_bytes: int = Field(
        default=256 * 1024, ge=1024, le=_MAX_UPLOAD_BYTES, description="Largest file a student may upload."
    )
    max_package_bytes: int = Field(
        default=1024 * 1024,
        ge=1024,
        le=_MAX_UPLOAD_BYTES,
        description="Largest zip of a package that a student may upload.",
    )
    max_open_submissions: Count = Field(
        default=50, description="Most submissions of one student that may wait for grading at once."
    )
    requests_per_minute: Count = Field(
        default=600, description="Most requests of one student of a course in a minute."
    )
    uploads_per_minute: Count = Field(
        default=60, description="Most uploads under one student's name in a minute."
    )
    requests_at_once: Count = Field(
        default=12,
        description="Most requests of one person of a course under way at once, besides streams of events.",
    )
    costly_at_once: Count = Field(
        default=6,  # as many as a browser sends at once to one host
        description="Of these, most of one student for results, plots and exports.",
    )
    costly_per_minute: Count = Field(
        default=120,
        description="Most requests of one student for results, plots and exports in a minute; a plot counts "
        "as four.",
    )
    pass_fraction: float = Field(
        default=0.6, ge=0.0, le=1.0, description="Share of the points from which the dashboard says passed."
    )
    plot_cache_entries: int = Field(
        default=256, ge=0, le=1_000_000, description="Rendered plots kept in memory, about 60 KB each."
    )
    slots: int = Field(
        default_factory=lambda: os.cpu_count() or 1,
        ge=0,
        le=256,
        description="Gradings at once in this process, one child process each; 0 leaves grading to others. "
        "By default one per core.",
    )
    lease_s: float = Field(
        default=15.0,
        gt=0.0,
        le=1_800.0,  # a claim for more than `clock.LONGEST_PAUSE` counts as made while the clock was ahead
        description="A grading whose worker is silent for so long is given to another.",
    )
    heartbeat_s: float = Field(
        default=3.0,
        ge=0.01,
        le=600.0,
        description="How often a worker says that it lives; at most a third of the lease.",
    )
    poll_s: float = Field(
        default=0.5,
        ge=0.01,
        le=60.0,
        description="How often an idle worker looks for work that nobody announced.",
    )
    max_tries: Count = Field(default=5, description="Tries before a submission ends as infrastructure_error.")
    retry_backoff_s: float = Field(
        default=1.0,
        ge=0.0,
        le=3_600.0,
        description="Pause after a failed try; doubled after each further one, up to an hour.",
    )
    drain_s: float = Field(
        default=30.0,
        ge=0.0,
        le=3_600.0,
        description="Time that running gradings get to finish when the service stops.",
    )

    max_streams: int = Field(
        default=500, ge=1, le=10_000, description="Most streams of events (live progress) open at once."
    )
    streams_per_person: Count = Field(
        default=10, description="Most streams of events one person may have open."
    )
    live_cars: int = Field(
        default=20,
        ge=0,
        le=200,
        description="Most live cars at once, one child process each of about 60 MB; 0: none are offered.",
    )
    practice_runs: int = Field(
        default=1,
        ge=0,
        le=16,
        description="Most practice runs at once, one grading process each while it is used; 0: none are offered.",
    )
    practice_per_minute: Count = Field(
        default=12,
        description="Practice runs of one person in a minute; one of many seconds counts as many.",
    )
    metrics_token: SecretStr | None = Field(
        default=None,
        description="Token that opens `/metrics`, at least 16 characters; without it, only those who may see the "
        "class see the measurements.",
    )
    metrics_port: int | None = Field(
        default=None,
        ge=0,
        le=65_535,
        description="Port where `grader worker`, or `grader serve` besides its own, answers `/metrics`, on the "
        "address GRADER_HOST, without asking for a token; by default none.",
    )
    log_format: LogFormat = Field(
        default="text", description="Lines of the log on stderr: `text` for people, `json` for machines."
    )
    log_level: LogLevel = Field(
        default="info", description="Least important lines the log has: `debug`, `info`, `warning`, `error`."
    )

    @property
    def assignment_folders(self) -> tuple[Path, ...]:
        """Return the folders of the operator's own assignments."""
        return tuple(Path(path) for path in self.assignments.split(os.pathsep) if path)

    @property
    def silent_s(self) -> float:
        """Return after how long a worker that says nothing no longer counts as alive."""
        return self.heartbeat_s * _SILENT_BEATS

    @field_validator("database_url")
    @classmethod
    def _durable(cls, value: str) -> str:
        try:
            url = make_url(value)
        except (ArgumentError, ValueError):  # their messages may repeat parts of a password
            raise ValueError(
                "is not a database URL such as sqlite:////var/lib/grader/grader.db",
                "不是数据库地址，例如 sqlite:////var/lib/grader/grader.db",
            ) from None
        if url.drivername in ("postgres", "postgresql", _POSTGRESQL):
            if not url.database:
                raise ValueError(
                    "must name the database: postgresql+psycopg://user@host/name",
                    "没有写数据库名：postgresql+psycopg://用户@主机/数据库",
                )
            if "@" in (url.host or ""):
                raise ValueError("has an @ in its password: write it as %40", "密码里的 @ 要写成 %40")
            return url.set(drivername=_POSTGRESQL).render_as_string(hide_password=False)
        if url.drivername not in ("sqlite", "sqlite+pysqlite"):
            raise ValueError(
                f"knows SQLite and PostgreSQL ({_POSTGRESQL}://...), not {url.drivername}",
                f"只能用 SQLite 或 PostgreSQL（{_POSTGRESQL}://...），不能用 {url.drivername}",
            )
        if url.database in (None, "", ":memory:") or "mode" in url.query:
            raise ValueError(
                "must name a file: a database in memory would lose every submission",
                "必须是文件：内存里的数据库会丢掉全部提交",
            )
        return value

    @field_validator("mail_server")
    @classmethod
    def _a_mail_server(cls, value: str) -> str:
        if value and not _is_mail_server(value):
            raise ValueError(
                "is no mail server such as smtps://mail.example.edu or smtp://mail.example.edu:587",
                "不是邮件服务器地址，例如 smtps://mail.example.edu 或 smtp://mail.example.edu:587",
            )
        return value

    @field_validator("mail_from")
    @classmethod
    def _a_mail_address(cls, value: str) -> str:
        if value and not _MAIL_ADDRESS.fullmatch(value):
            raise ValueError(
                "is no e-mail address such as grader@example.edu", "不是邮箱地址，例如 grader@example.edu"
            )
        return value

    @model_validator(mode="after")
    def _mail_as_a_whole(self) -> Self:
        if self.mail_server and not self.mail_from:
            raise ValueError(
                "mail_from: say which address e-mail comes from, as there is a mail_server",
                "mail_from：设了 mail_server，就要写明邮件从哪个地址发出",
            )
        password = self.mail_password and self.mail_password.get_secret_value()
        if not f"{self.mail_user}{password or ''}".isascii():
            raise ValueError(
                "mail_user and mail_password: only ASCII, other letters cannot be sent to mail servers",
                "mail_user 和 mail_password：只能用 ASCII 字符，别的字符无法发给邮件服务器",
            )
        if bool(self.mail_user) != bool(password):
            raise ValueError(
                "mail_user and mail_password: set both of them, or neither",
                "mail_user 和 mail_password：要么都设，要么都不设",
            )
        return self

    @field_validator("instructor_token", "metrics_token")
    @classmethod
    def _hard_to_guess(cls, value: SecretStr | None) -> SecretStr | None:
        if value is None:
            return None
        token = value.get_secret_value()
        if len(token) < _SHORTEST_TOKEN or len(set(token)) < _SHORTEST_TOKEN // 2:
            raise ValueError(
                f"is too easy to guess: use at least {_SHORTEST_TOKEN} random characters",
                f"太容易猜到：至少用 {_SHORTEST_TOKEN} 个随机字符",
            )
        if not (token.isascii() and token.isprintable()) or " " in token:
            raise ValueError(
                "must be printable ASCII without spaces, to fit an HTTP header",
                "只能用英文字母、数字和符号，不能有空格，因为要放进 HTTP 头",
            )
        return value

    @model_validator(mode="after")
    def _heart_beats_within_the_lease(self) -> Self:
        if self.heartbeat_s * _RENEWALS_PER_LEASE > self.lease_s:
            raise ValueError(
                f"heartbeat_s {self.heartbeat_s:g} must be at most a third of lease_s {self.lease_s:g}: "
                "one late heartbeat would give away gradings that run well",
                f"heartbeat_s {self.heartbeat_s:g} 不能超过 lease_s {self.lease_s:g} 的三分之一："
                "否则心跳只要迟到一次，正常进行的评分就会被转给别人",
            )
        return self


def load(**overrides: Any) -> Settings:
    """Return the settings of the environment, `overrides` (of the command line; None: not given) before them.

    Raises SettingsError: a value is refused, or a name misspelt; the message names the setting and says why.
    """
    _check_names()
    try:
        return Settings(**{name: value for name, value in overrides.items() if value is not None})
    except ValidationError as error:
        problems = error.errors()
        en, zh = (
            "\n".join(_sentence(problem, language) for problem in problems) for language in ("en", "zh")
        )
        raise SettingsError(en, zh) from None


def _check_names() -> None:
    names = [_PREFIX + name.upper() for name in Settings.model_fields]
    for name in sorted(os.environ):
        if not name.startswith(_PREFIX) or name in names or name == _OF_PRAIRIELEARN:
            continue
        for meant in set(difflib.get_close_matches(name, names, n=1, cutoff=_ALIKE)) - set(os.environ):
            raise SettingsError(
                f"{name}: there is no such setting; is it {meant}?", f"{name}：没有这个设置，是不是 {meant}？"
            )


def _is_mail_server(address: str) -> bool:
    try:
        parts = urlsplit(address)
        named = bool(parts.hostname) and parts.port != 0
    except ValueError:
        return False
    plain = f"{parts.scheme}://{parts.netloc}" == address and not parts.username
    return plain and named and parts.scheme in ("smtp", "smtps")


def is_loopback(host: str) -> bool:
    """Whether only this machine can reach `host`. Names other than localhost are not looked up."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False


def _sentence(problem: Any, language: Language) -> str:
    text = said(problem, language)
    (name,) = problem["loc"] or ("",)
    if not name:
        return text
    colon = "：" if language == "zh" else ": "
    variable = str(name) if str(name).isupper() else f"{name} ({_PREFIX}{str(name).upper()})"
    return f"{variable}{colon}{text}"
