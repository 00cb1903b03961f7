"""The pictures of a PyBullet world on a submission's page."""

from collections.abc import Callable
from dataclasses import replace

from grader.contracts.grading import GradingJob, GradingResult
from grader.contracts.trajectory import Picture, decode_trajectory, encode_trajectory
from grader.formats.png import png_of
from tests.fakes.grading import grade
from tests.unit.service.web.conftest import Browser


def pictured(job: GradingJob) -> GradingResult:
    result = grade(job)
    motion = decode_trajectory(result.trajectories["default"])
    shown = tuple(Picture(t_ns=t_ns, png=png_of(2, 2, bytes(12))) for t_ns in (0, 10**9))
    return replace(result, trajectories={"default": encode_trajectory(replace(motion, pictures=shown))})


def test_the_film_is_there_where_pictures_are(browser: Browser, put: Callable[..., str]) -> None:
    address = put(student="s1", grading=pictured)
    browser.enter(student="s1")
    answer = browser.get(address + "/film.png")
    assert answer.headers["content-type"] == "image/png"
    assert b"acTL" in answer.content
    assert browser.get(address.replace("/submissions/", "/submissions/x") + "/film.png").status_code == 404


def test_a_run_without_pictures_has_none(browser: Browser, put: Callable[..., str]) -> None:
    address = put(student="s1")
    browser.enter(student="s1")
    assert browser.get(address + "/film.png").status_code == 404
