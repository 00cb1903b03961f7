"""The service keeps to its OpenAPI document, whoever asks and whatever is sent.

Requests are drawn from the document by schemathesis, valid and invalid ones, a few for each operation, in turn on
SQLite and on PostgreSQL, and always the same. ``GRADER_OPENAPI_EXAMPLES`` asks for more of them.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from datetime import timedelta
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from fastapi import FastAPI
from hypothesis import HealthCheck, Phase, given, note, settings

from grader.contracts.grading import GradingJob
from grader.contracts.identity import Role, RosterEntry
from grader.contracts.submission import NewSubmission, WorkerState
from grader.operation.settings import Settings
from grader.use_cases.services import Services
from tests.examples import examples
from tests.fakes import server
from tests.fakes.clock import FakeClock
from tests.fakes.grading import grade
from tests.fakes.postgres import PostgresServer

if TYPE_CHECKING:  # imported where it is used: every process of a run imports this module, and one runs it
    import requests
    import schemathesis
    from schemathesis import Case

EXAMPLES = int(os.environ.get("GRADER_OPENAPI_EXAMPLES", "2"))
ROLES = ("anybody", "operator", "student", "instructor")
MOST = 10**6
drawn = settings(
    max_examples=examples(EXAMPLES),
    deadline=None,
    derandomize=True,
    database=None,
    phases=[Phase.generate],
    suppress_health_check=list(HealthCheck),
)


@dataclass(frozen=True)
class Kept:
    """Services over one kind of database in which there is something to find, and who asks there."""

    services: Services
    headers: dict[str, str]
    known: dict[str, list[str]]


@dataclass(frozen=True)
class Asked:
    """The application, and what everybody finds over each kind of database, by role."""

    schema: schemathesis.BaseSchema
    app: FastAPI
    client: requests.Session
    kept: dict[str, tuple[Kept, ...]]
    checks: list[Callable[..., object]]
    numbers: Iterator[int]

    def call(self, case: Case) -> None:
        """Let everybody send a request, two of three about something that exists, and look at the answers.

        Drawing a request takes longer than answering it, so each is sent by all.
        """
        number = next(self.numbers)
        for role, both in self.kept.items():
            note(f"asked by {role}")
            kept = both[number % len(both)]
            self.app.state.services = kept.services
            if number % 3:
                for name in case.path_parameters or {}:
                    case.path_parameters[name] = kept.known[name][number % len(kept.known[name])]
                if isinstance(case.body, dict) and "assignment" in case.body:
                    case.body["assignment"] = "square"
            case.call_and_validate(session=self.client, headers=kept.headers, checks=self.checks)
            self.client.cookies.clear()


@pytest.fixture(scope="module")
def asked(
    tmp_path_factory: pytest.TempPathFactory, migrated_file: Path, postgres_server: PostgresServer
) -> Iterator[Asked]:
    import schemathesis
    from schemathesis.checks import not_a_server_error
    from schemathesis.python.asgi import get_client
    from schemathesis.specs.openapi import checks

    wanted = [
        not_a_server_error,
        checks.status_code_conformance,
        checks.content_type_conformance,
        checks.response_headers_conformance,
        checks.response_schema_conformance,
    ]
    names = {role: f"openapi_{role}_{os.getpid()}" for role in ROLES}
    files = {role: tmp_path_factory.mktemp(role) / "grader.db" for role in ROLES}
    for file in files.values():
        shutil.copy(migrated_file, file)
    with ExitStack() as opened:
        both = {
            role: [
                opened.enter_context(_services(url))
                for url in (f"sqlite:///{files[role]}", postgres_server.create(names[role]))
            ]
            for role in ROLES
        }
        app = server.application(both["anybody"][0])
        app.state.default_language = "zh"
        schema = schemathesis.openapi.from_dict(server.openapi_document())
        schema.app = app
        kept = {role: tuple(_kept(app, services, role) for services in both[role]) for role in ROLES}
        client = opened.enter_context(get_client(app))
        client.trust_env = False  # which would look for a proxy with each request
        yield Asked(schema, app, client, kept, wanted, count())
    for name in names.values():
        postgres_server.drop(name)


def takes_anything(path: str, method: str) -> bool:
    """Whether a request of this operation can be a wrong one."""
    described = server.committed_document()["paths"][path][method]
    return "{" in path or bool(described.keys() & {"parameters", "requestBody", "security"})


WAYS = [
    (path, method, way)
    for path, method in server.operations()
    for way in ("positive", "negative")
    if way == "positive" or takes_anything(path, method)
]


@pytest.mark.parametrize(("path", "method", "way"), WAYS)
def test_answers_are_those_of_the_document(asked: Asked, path: str, method: str, way: str) -> None:
    from schemathesis import GenerationMode

    operation = asked.schema[path][method]

    @drawn
    @given(case=operation.as_strategy(generation_mode=GenerationMode(way)))
    def all_of_them(case: Case) -> None:
        asked.call(case)

    all_of_them()


@contextmanager
def _services(url: str) -> Iterator[Services]:
    often = {"requests_per_minute": MOST, "uploads_per_minute": MOST, "max_open_submissions": MOST}
    with server.services(Settings(database_url=url, **often), FakeClock()) as services:
        services.watching.limits = replace(services.watching.limits, life_s=0.01, most_each=MOST)
        now = services.clock()
        services.workers.report(
            WorkerState(
                id="w",
                slots=1,
                busy=0,
                sandbox_ready=True,
                isolation="strict",
                detail="",
                started_at=now,
                seen_at=now,
            )
        )
        yield services


def _kept(app: FastAPI, services: Services, role: str) -> Kept:
    app.state.services = services
    headers = _headers(services, role)
    course = None if role in ("anybody", "operator") else "ros"
    return Kept(services, headers, _known(app, services, course, headers))


def _headers(services: Services, role: str) -> dict[str, str]:
    if role == "anybody":
        return {}
    if role == "operator":
        return {"Authorization": f"Bearer {server.TOKEN}"}
    services.courses.create("ros", "ROS", "Asia/Shanghai", "test")
    people = [
        RosterEntry(id="li", name="李", role=Role(role)),
        RosterEntry(id="han", name="韩", role=Role.STUDENT),
    ]
    services.courses.import_roster("ros", people, "test")
    _, token = services.tokens.issue("ros", "li", timedelta(days=1), "test")
    return {"Authorization": f"Bearer {token}"}


def _known(
    app: FastAPI, services: Services, course: str | None, headers: dict[str, str]
) -> dict[str, list[str]]:
    """Hand in three files, have two of them graded, and begin to grade again where that is allowed."""
    known = {
        "assignment_id": ["square", "straight"],
        "student": ["li", "han"],
        "identity": ["none"],
        "platform": ["none"],
        "outlet": ["class", "staff"],
        "mistake": ["rate_off", "none"],
        "person": ["zhou", "zhu"],  # nobody whom other requests need: they are removed, too
        "item": ["sides", "closed"],
        "code": ["empty", "syntax_error"],
        "submission_id": [_handed_in(services, course, number) for number in range(3)],
    }
    for _ in range(2):
        claim = services.queue.claim("w")
        assert claim is not None
        assignment = services.assignments.get(claim.assignment)
        job = GradingJob(file_name=claim.file_name, source=claim.source, assignment=assignment)
        assert services.queue.finish(claim, grade(job), assignment)
    from schemathesis.python.asgi import get_client

    with get_client(app) as client:
        begun = client.post(
            "http://testserver/api/v1/regrades", json={"assignment": "square"}, headers=headers
        )
    return {**known, "regrade_id": [begun.json()["id"] if begun.status_code == 202 else "none"]}


def _handed_in(services: Services, course: str | None, number: int) -> str:
    source = f"good good  # {number}\n".encode()
    new = NewSubmission(
        student="li", assignment="square", file_name="square.py", source=source, course=course
    )
    return services.intake.accept(new, services.clock())[0].id
