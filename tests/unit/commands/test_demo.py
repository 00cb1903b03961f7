"""`grader demo` as a client of the service."""

import httpx
import pytest

from grader.commands.demo import DemoUpload, hand_in
from grader.contracts.errors import InfrastructureError


def client_answered(*answers: httpx.Response) -> httpx.Client:
    waiting = list(answers)
    return httpx.Client(
        base_url="http://service", transport=httpx.MockTransport(lambda request: waiting.pop(0))
    )


UPLOAD = DemoUpload("ada", "square", "a.py", b"x = 1\n")


def test_an_upload_waits_while_the_student_has_too_many_open() -> None:
    full = httpx.Response(429, headers={"Retry-After": "0"})
    taken = httpx.Response(202, headers={"Location": "/api/v1/submissions/7"})
    assert hand_in(client_answered(full, full, taken), UPLOAD) == "/api/v1/submissions/7"


def test_a_refused_upload_ends_the_demo() -> None:
    with pytest.raises(InfrastructureError, match=r"a\.py was refused: no such"):
        hand_in(client_answered(httpx.Response(404, text="no such")), UPLOAD)
