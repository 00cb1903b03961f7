"""The look at an upload's syntax, in a real confined process."""

import threading
from collections.abc import Iterator
from contextlib import suppress

import pytest

from grader.contracts.errors import InfrastructureError, SandboxError
from grader.contracts.grading import SyntaxProblem
from grader.grading.preflight import SandboxPreflight
from grader.sandbox import syntax_sandbox
from tests.fakes.processes import zygote_of


@pytest.fixture(scope="module")
def preflight() -> Iterator[SandboxPreflight]:
    with (
        syntax_sandbox("strict") as one,
        syntax_sandbox("strict") as other,
        SandboxPreflight(one, other) as preflight,
    ):
        yield preflight


def test_python_is_taken_and_not_run(preflight: SandboxPreflight) -> None:
    assert preflight.check(b"import os\nos.abort()\nwhile True: pass\n", "a.py") is None


def test_what_is_wrong_is_told_with_its_place(preflight: SandboxPreflight) -> None:
    problem = preflight.check("# 你好\nif True:\n    prin(1))\n".encode(), "a.py")
    assert problem == SyntaxProblem(
        message="SyntaxError: unmatched ')'", line=3, column=12, text="    prin(1))"
    )


def test_what_the_compiler_finds_late_has_its_line_too(preflight: SandboxPreflight) -> None:
    problem = preflight.check(b"x = 1\nreturn x\n", "a.py")
    assert problem is not None
    assert (problem.message, problem.line, problem.text) == (
        "SyntaxError: 'return' outside function",
        2,
        "return x",
    )


@pytest.mark.parametrize("source", [b"(" * 100_000, b"-" * 100_000 + b"1", b"# coding: no-such\n"])
def test_an_attack_on_the_compiler_is_a_problem_of_the_file(
    preflight: SandboxPreflight, source: bytes
) -> None:
    assert preflight.check(source, "a.py") is not None
    assert preflight.check(b"x = 1\n", "a.py") is None


def test_many_at_once_get_their_own_answers(preflight: SandboxPreflight) -> None:
    answers: dict[int, int | None] = {}

    def ask(number: int) -> None:
        problem = preflight.check(b"\n" * number + b"x = = 1\n", "a.py")
        answers[number] = problem and problem.line

    threads = [threading.Thread(target=ask, args=(number,)) for number in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert answers == {number: number + 1 for number in range(8)}


def test_a_check_that_waits_for_others_is_not_busy() -> None:
    told: list[float] = []
    with syntax_sandbox("strict") as sandbox, SandboxPreflight(sandbox) as preflight:
        held = preflight._idle.get()
        threading.Timer(1.0, preflight._idle.put, [held]).start()
        assert preflight.check(b"x = 1\n", "a.py", told.append) is None
    (busy_s,) = told
    assert 0.0 < busy_s < 0.9


def test_after_a_fault_the_next_check_works() -> None:
    with syntax_sandbox("strict") as sandbox, SandboxPreflight(sandbox) as preflight:
        zygote_of(sandbox).kill()
        with suppress(SandboxError):
            preflight.check(b"x = 1\n", "a.py")
        assert preflight.check(b"x = = 1\n", "a.py") is not None


def test_checks_under_way_end_although_it_was_closed() -> None:
    with syntax_sandbox("strict") as sandbox:
        preflight = SandboxPreflight(sandbox)
        preflight.close()
        assert preflight.check(b"x = = 1\n", "a.py") is not None
        assert preflight.check(b"x = 1\n", "a.py") is None


def test_nobody_waits_for_ever() -> None:
    with (
        SandboxPreflight() as preflight,
        pytest.raises(InfrastructureError, match="no syntax check was free"),
    ):
        preflight.check(b"x = 1\n", "a.py", patience_s=0.0)
