"""Exercises about what nodes say: their own scripts get what they must."""

import io
from pathlib import Path

import pytest
from rich.console import Console

from grader.catalog import Catalog, set_root
from grader.commands.validation import examine
from grader.contracts.figure import FigureSketch
from grader.contracts.grading import Grader, GradingJob
from grader.contracts.text import EMPTY
from grader.contracts.trajectory import decode_trajectory
from grader.render.plot import plot
from grader.render.timeline import render_timeline

TEACHERS = Catalog(Path(__file__).parent / "exercises")
SHIPPED = Catalog(set_root("nodes"))


@pytest.mark.parametrize("name", [each.id for each in TEACHERS.all()])
def test_a_teachers_own_exercises_are_valid(grader: Grader, name: str) -> None:
    assert problems(TEACHERS, name, grader) == []


@pytest.mark.parametrize("name", [each.id for each in SHIPPED.all()])
def test_the_exercises_of_the_set_are_valid(grader: Grader, name: str) -> None:
    assert SHIPPED.get(name).max_score == 100
    assert len(SHIPPED.wrong_attempts(name)) >= 6
    assert problems(SHIPPED, name, grader) == []


def problems(catalog: Catalog, name: str, grader: Grader) -> list[tuple[str, str]]:
    """Return what is wrong with an exercise; of one of the set also the expectations that test nothing."""
    examination = examine(catalog, name, grader)
    findings = examination.findings
    idle = [(place, "tests nothing") for place in examination.idle if catalog is SHIPPED]
    return idle + [(each.script, each.problem.en) for each in findings if each.problem != EMPTY]


TALKER = SHIPPED.scripts("talker")["solution.py"].decode()
SPEED = SHIPPED.scripts("speed_parameter")["solution.py"].decode()
SUMS = SHIPPED.scripts("add_server")["solution.py"].decode()
CLIENT = SHIPPED.scripts("add_client")["solution.py"].decode()
TEXT = "f'Hello World: {self.count}'"
SETS_SUM = "        response.sum ="


@pytest.mark.parametrize(
    ("name", "source", "most"),
    [
        pytest.param("talker", TALKER.replace(TEXT, "'x' * 1_000_000"), 20, id="huge"),
        pytest.param("talker", TALKER.replace(TEXT, "'x' * 60_000"), 60, id="large"),
        pytest.param(
            "talker",
            TALKER.replace(
                "        self.publisher.publish(msg)\n",
                "        for _ in range(20_000):\n            self.publisher.publish(msg)\n",
            ),
            60,
            id="flood",
        ),
        pytest.param("talker", TALKER.replace("publish(msg)", "publish(b'\\xff' * 9)"), 65, id="raw bytes"),
        pytest.param("speed_parameter", SPEED.replace("msg.data =", "msg.data = float('nan') *"), 90, id="NaN"),
        pytest.param("add_server", SUMS.replace("request.a + request.b\n", "2**63 - 1\n"), 30, id="largest"),
        pytest.param("add_client", CLIENT.replace("int(msg.x)", "2**63 - 1"), 45, id="no answer to that"),
        pytest.param(
            "add_server", SUMS.replace(SETS_SUM, f"        rclpy.spin(self)\n{SETS_SUM}"), 30, id="never",
        ),
        pytest.param(
            "add_server",
            SUMS.replace(SETS_SUM, f"        import time\n        time.sleep(8)\n{SETS_SUM}"),
            30,
            id="late",
        ),
    ],
)  # fmt: skip
def test_hostile_answers_are_bounded_and_the_scripts_fault(
    grader: Grader, name: str, source: str, most: float
) -> None:
    job = GradingJob(file_name="script.py", source=source.encode(), assignment=SHIPPED.get(name))
    first, second = grader.grade(job), grader.grade(job)
    assert first.report.sha256() == second.report.sha256()
    assert first.report.score is not None
    assert first.report.score <= most
    assert len(first.report.canonical_bytes()) < 200_000
    assert all(len(each) < 500_000 for each in first.trajectories.values())


def test_what_was_drawn_depends_on_the_file_and_is_the_same_each_time(grader: Grader) -> None:
    task = SHIPPED.get("add_server")
    sent = []
    for source in (SUMS, SUMS, SUMS + "# another file\n"):
        result = grader.grade(GradingJob(file_name="script.py", source=source.encode(), assignment=task))
        said = decode_trajectory(result.trajectories["default"]).sayings
        sent.append([each.text for each in said if each.t_ns >= 4_000_000_000])
        assert (said[0].way, said[0].name, said[0].text) == (
            "call",
            "/add_two_ints",
            "a = 3, b = 4 → sum = 7",
        )
    assert sent[0] == sent[1] != sent[2]


def test_a_conversation_is_drawn_and_listed(grader: Grader) -> None:
    task = SHIPPED.get("fibonacci_server")
    source = SHIPPED.scripts("fibonacci_server")["solution.py"]
    result = grader.grade(GradingJob(file_name="script.py", source=source, assignment=task))
    track, report = decode_trajectory(result.trajectories["default"]), result.report
    pictures = {plot(task, report, track, FigureSketch(view="talk"), form="svg") for _ in range(2)}
    assert len(pictures) == 1
    console = Console(width=200, record=True, file=io.StringIO())
    console.print(render_timeline(report.runs[0].outcome, track, language="en"))
    text = console.export_text()
    assert "/fibonacci  order = 0 (REJECTED)  answered after 0 s" in text
    assert "(CANCELED)" in text
    assert "← /fibonacci feedback  sequence = [0, 1, 1]" in text
