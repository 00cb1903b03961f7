import logging

import pytest

from grader.commands.cli import run


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--slots", "0"], "would grade nothing"),
        (["--slots", "-1"], "slots"),
        (["--database-url", "mysql://x/y"], "database_url"),
    ],
)
def test_a_worker_that_could_not_work_says_why(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    handlers = logging.getLogger().handlers
    assert run(["worker", *arguments, "--lang", "en"]) == 2
    assert said in capsys.readouterr().err
    assert logging.getLogger().handlers is handlers  # a refused command leaves the process as it was
