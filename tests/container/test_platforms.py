"""The image as PrairieLearn's external grader: no network, its own filter, a folder in, a document out."""

import json
from typing import Any

import pytest

from grader.catalog import Catalog
from tests.container.running import good
from tools.image.runtime import Runtime

LARGEST_BYTES = 1_000_000
HOSTILE = {
    "forge": "open('/data/grade/results/results.json', 'w').write('{\"score\": 1.0}')",
    "steal": "print(open('/opt/grader/lib/python3.11/site-packages/grader/assignments/hello/solution.py').read())",
    "hide": "import os, signal; os.kill(os.getppid(), signal.SIGKILL)",
}


def _graded(runtime: Runtime, source: str) -> dict[str, Any]:
    grade = runtime.folder / "data" / "grade"
    for folder in (grade, grade / "student", grade / "results"):
        folder.mkdir(exist_ok=True)
        folder.chmod(0o777)  # as PrairieLearn leaves them for an image's user
    (grade / "student" / "hello.py").write_text(source, encoding="utf-8")
    (grade / "results" / "results.json").unlink(missing_ok=True)
    arguments = ("prairielearn", "--root", "/data/grade", "--assignment", "hello", "--lang", "en")
    good(runtime.run(*arguments))
    content = (grade / "results" / "results.json").read_bytes()
    assert len(content) <= LARGEST_BYTES
    document: dict[str, Any] = json.loads(content)
    return document


def test_a_solution_gets_full_points_and_a_picture(runtime: Runtime) -> None:
    document = _graded(runtime, (Catalog().folder("hello") / "solution.py").read_text("utf-8"))
    assert document["score"] == 1.0
    assert document["images"][0]["url"].startswith("data:image/png;base64,")


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_script_gets_nothing(name: str, runtime: Runtime) -> None:
    document = _graded(runtime, HOSTILE[name] + "\n")
    assert document["score"] == 0.0
    assert "rclpy.spin" not in document["output"]


def test_a_run_can_be_written_as_a_bag(runtime: Runtime) -> None:
    """The image has what writes bags."""
    (runtime.folder / "data" / "hello.py").write_bytes(
        (Catalog().folder("hello") / "solution.py").read_bytes()
    )
    good(runtime.run("check", "hello.py", "-a", "hello", "--record", "/tmp/run.mcap"))
