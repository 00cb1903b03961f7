"""`grader check` and `grader run`, as typed, where it does not come to a grading."""

from pathlib import Path

import pytest

from grader.commands import check, cli, run
from grader.contracts.errors import GraderError, InfrastructureError, SandboxUnavailableError
from grader.contracts.outcome import StudentError
from tests.unit.render.samples import outcome, report

DIED = InfrastructureError("the grading process ended unexpectedly (exit code 1)")
NO_JAIL = SandboxUnavailableError("this host lacks a required layer of isolation: seccomp")


class FailingSlot:
    """A slot in which nothing can be graded."""

    error: GraderError

    def __init__(self, config: object) -> None:
        pass

    def __enter__(self) -> "FailingSlot":
        return self

    def __exit__(self, *error: object) -> None:
        pass

    def grade(self, *job: object) -> None:
        raise self.error


@pytest.mark.parametrize(
    ("module", "folder"), [("rosclaw_msgs", "rosclaw"), ("rosclaw_msgs.srv", "rosclaw"), ("pandas", None)]
)
def test_run_knows_which_assignment_brings_an_interface(module: str, folder: str | None) -> None:
    error = StudentError(
        type="ModuleNotFoundError", message=f"No module named '{module}'", line=1, traceback=""
    )
    found = run._interfaces_for(report(outcome=outcome(error=error)))
    assert (found and found.name) == folder


@pytest.mark.parametrize("command", ["check", "run"])
@pytest.mark.parametrize(
    ("error", "lang", "words"),
    [
        (DIED, "zh", "不是你的脚本的问题"),
        (DIED, "en", "not your script"),
        (NO_JAIL, "zh", "这台电脑缺少"),
        (NO_JAIL, "en", "grader doctor"),
    ],
)
def test_a_fault_of_the_grader_is_not_blamed_on_the_script(
    command: str,
    error: GraderError,
    lang: str,
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(FailingSlot, "error", error, raising=False)
    for module in (check, run):
        monkeypatch.setattr(module, "Slot", FailingSlot)
    (tmp_path / "hello.py").write_text("import rclpy\n")
    assert cli.run([command, str(tmp_path / "hello.py"), "--lang", lang]) == cli.EXIT_NOT_DONE
    told = capsys.readouterr().err
    assert words in told
    assert str(error) in told
