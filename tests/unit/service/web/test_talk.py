"""What was said in a run, on a submission's page: a drawing, and the same as a table."""

from collections.abc import Callable
from dataclasses import replace

from grader.contracts.conversation import Saying
from grader.contracts.grading import GradingJob, GradingResult
from grader.contracts.trajectory import decode_trajectory, encode_trajectory
from grader.service.web.talk import talk_page
from tests.fakes.grading import grade
from tests.unit.service.web.conftest import Browser

SECOND = 1_000_000_000
SAID = (
    Saying(SECOND, "in", "/numbers", "data = 3"),
    Saying(SECOND, "out", "/doubled", "data = 6 <b>"),
    Saying(2 * SECOND, "call", "/add", "a = 3, b = 4 → sum = 7", 4 * SECOND),
    Saying(5 * SECOND, "call", "/add", "a = 1, b = 2"),
    Saying(6 * SECOND, "ask", "/spawn", "x = 1", 7 * SECOND),
)


def talkative(job: GradingJob) -> GradingResult:
    result = grade(job)
    motion = replace(decode_trajectory(result.trajectories["default"]), sayings=SAID)
    return replace(result, trajectories={"default": encode_trajectory(motion)})


def test_marks_lie_where_they_came_and_calls_lead_to_their_answers() -> None:
    talk = talk_page(SAID, 10 * SECOND, "en")
    assert talk is not None
    assert [lane.name for lane in talk.lanes] == ["/numbers", "/doubled", "/add", "/spawn"]
    answered, silent = talk.lanes[2].marks
    assert (answered.kind, answered.begin, answered.end) == ("call", "20.60%", "40.20%")
    assert (silent.kind, silent.end) == ("silent", None)
    assert [row.arrow for row in talk.rows] == ["→", "←", "→", "→", "←"]
    assert "no answer" in talk.rows[3].text
    assert talk_page((), SECOND, "en") is None


def test_a_long_conversation_is_cut_and_says_so() -> None:
    many = tuple(Saying(k * SECOND, "out", f"/t{k % 30}", "data = 1") for k in range(250))
    talk = talk_page(many, 250 * SECOND, "zh")
    assert talk is not None
    assert (len(talk.lanes), len(talk.rows), talk.left_out) == (20, 200, 50)


def test_the_page_has_the_drawing_and_the_table(browser: Browser, put: Callable[..., str]) -> None:
    address = put(student="s1", grading=talkative)
    browser.enter(student="s1")
    page = browser.get(address).text
    assert page.count('role="img" aria-label="/') == 4
    assert "data = 6 &lt;b&gt;" in page
    other = put(student="s1")
    assert 'id="talk"' not in browser.get(other).text
