"""`grader check`, as typed, where it does not come to a grading."""

from pathlib import Path

import pytest

from grader import cli
from grader.commands import check
from grader.contracts.errors import InfrastructureError


class FailingSlot:
    """A slot whose grading process dies."""

    def __init__(self, config: object) -> None:
        pass

    def __enter__(self) -> "FailingSlot":
        return self

    def __exit__(self, *error: object) -> None:
        pass

    def grade(self, *job: object) -> None:
        raise InfrastructureError("the grading process ended unexpectedly (exit code 1)")


@pytest.mark.parametrize(("lang", "words"), [("zh", "不是你的脚本的问题"), ("en", "not your script")])
def test_a_fault_of_the_grader_is_not_blamed_on_the_script(
    lang: str, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(check, "Slot", FailingSlot)
    (tmp_path / "hello.py").write_text("import rclpy\n")
    assert cli.run(["check", str(tmp_path / "hello.py"), "--lang", lang]) == cli.EXIT_COULD_NOT
    told = capsys.readouterr().err
    assert words in told
    assert "exit code 1" in told
