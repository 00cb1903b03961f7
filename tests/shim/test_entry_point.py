"""Scripts that are started as ros2 run starts an executable: imported, then `main` is called."""

from collections.abc import Callable
from typing import Any

import pytest

RunScript = Callable[..., Any]
MAIN = "def main():\n    print('driven', __name__)\n"


def started(run_bare: RunScript, source: str, **options: Any) -> Any:
    return run_bare(source, runs_as="ros2_run", file_name="square_mover.py", **options)


@pytest.mark.parametrize(
    ("source", "stdout", "notes"),
    [
        (MAIN, "driven square_mover\n", ["main_called"]),
        (MAIN + "if __name__ == '__main__':\n    main()\n", "driven square_mover\n", []),
        (MAIN + "if __name__ == '__main__':\n    sys.exit(main())\n", "driven square_mover\n", []),
        (MAIN + "main()\n", "driven square_mover\n" * 2, ["main_twice"]),
        ("main = lambda: print('lambda')\n", "lambda\n", []),
    ],
)
def test_main_is_called_once_by_the_entry_point(
    run_bare: RunScript, source: str, stdout: str, notes: list[str]
) -> None:
    run = started(run_bare, source)
    assert (run.stdout, run.exit["reason"], [code for code, _ in run.notes]) == (stdout, 0, notes)
    if "lambda" not in source and not source.endswith("\nmain()\n"):
        assert "main_called" not in dict(run_bare(source).notes)


@pytest.mark.parametrize(("returned", "code", "stderr"), [("None", 0, ""), ("3", 3, ""), ("'no'", 1, "no\n")])
def test_the_process_exits_with_what_main_returns(
    run_bare: RunScript, returned: str, code: int, stderr: str
) -> None:
    run = started(run_bare, f"def main(): return {returned}\n")
    assert (run.exit["code"], run.stderr) == (code, stderr)


def test_a_file_without_main_ends_as_its_executable_would(run_bare: RunScript) -> None:
    run = started(run_bare, "print('imported')\nif __name__ == '__main__':\n    print('never')\n")
    assert (run.stdout, run.exit["type"], run.exit["line"]) == ("imported\n", "AttributeError", 0)
    assert run.exit["message"] == "module 'square_mover' has no attribute 'main'"


def test_an_error_in_main_shows_the_lines_of_the_script(run_bare: RunScript) -> None:
    run = started(run_bare, "def main():\n    drive()\n")
    assert (run.exit["type"], run.exit["line"]) == ("NameError", 2)
    assert 'File "square_mover.py", line 2, in main\n' in run.stderr


def test_classes_can_be_pickled_and_a_name_that_is_taken_stays(run_bare: RunScript) -> None:
    source = "import pickle\nclass A: pass\ndef main(): print(type(pickle.loads(pickle.dumps(A()))) is A)\n"
    assert started(run_bare, source).stdout == "True\n"
    source = "import json\ndef main(): print(json.dumps(1))\n"
    assert run_bare(source, runs_as="ros2_run", file_name="json.py").stdout == "1\n"
