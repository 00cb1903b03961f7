"""`grader completion`: the script that a shell gets knows every command and assignment."""

import subprocess
from pathlib import Path

import pytest

from grader.commands import cli


def test_bash_completes_commands_options_and_assignments(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    pytest.importorskip("shtab")
    assert cli.run(["completion", "bash"]) == 0
    script = tmp_path / "completion.bash"
    script.write_text(capsys.readouterr().out, encoding="utf-8")
    asked = (["che"], ["check", "--pl"], ["check", "-a", "hexa"], ["token", "rev"])
    lines = [
        f"COMP_WORDS=(grader {' '.join(words)}); COMP_CWORD={len(words)}; COMPREPLY=(); _shtab_grader; "
        'echo "${COMPREPLY[@]}"'
        for words in asked
    ]
    done = subprocess.run(
        ["bash", "-c", "\n".join([f"source {script}", *lines])], capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == ["check", "--plot", "hexagon", "revoke"]
