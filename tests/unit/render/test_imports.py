"""What is imported on hot paths must not pull in rich, matplotlib or numpy."""

import subprocess
import sys

import pytest


@pytest.mark.parametrize("module", ["grader.render", "grader.render.documents", "grader.render.escape"])
def test_cheap_modules_stay_cheap(module: str) -> None:
    program = f"import sys, {module}; print({{'rich', 'matplotlib', 'numpy'}} & set(sys.modules))"
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "set()"
