"""Grades for other systems."""

import csv
import io
from collections.abc import Callable
from dataclasses import replace
from datetime import timedelta
from decimal import Decimal
from typing import Any

import httpx
import pytest
from hypothesis import given
from hypothesis import strategies as st
from python_calamine import CalamineWorkbook

from grader.contracts.dashboard import StudentProgress
from grader.contracts.identity import Member, Role, RosterEntry
from grader.contracts.report import GradeStatus
from grader.contracts.rules import LateRule, Rules
from grader.contracts.submission import SubmissionState
from grader.store.audit import Signature
from grader.use_cases.gradebook import canvas, percentage, plain
from grader.use_cases.services import Services
from tests.fakes.clock import START, FakeClock
from tests.fakes.grading import assignment
from tests.fakes.server import TOKEN

URL = "/api/v1/gradebook.csv"
HEAD = ("Student", "ID", "SIS User ID", "SIS Login ID", "Section")


def table(response: httpx.Response) -> list[list[str]]:
    assert response.headers["content-type"] == "text/csv; charset=utf-8"
    assert "attachment" in response.headers["content-disposition"]
    return list(csv.reader(io.StringIO(response.content.decode("utf-8-sig"))))


def test_every_student_has_a_line_with_what_counts(
    client: httpx.Client, services: Services, graded: Callable[..., str], clock: FakeClock, school: Any
) -> None:
    late = Rules(due=START + timedelta(hours=1), late=LateRule(kind="linear", per_day=0.5))
    services.rules.set("square", late, Signature(START, "ros", "test"))
    services.courses.import_roster("ros", [RosterEntry(id="li", name="李雷", role=Role.STUDENT)], "test")
    graded(b"good", student="", headers=school.as_("li"))
    clock.advance(7200)
    graded(b"good good # late", student="", headers=school.as_("li"))
    graded(b"good", student="", assignment="straight", headers=school.as_("li"))
    graded(b"good", student="", headers=school.as_("wang"))
    rows = table(client.get(URL, headers=school.as_("ta")))
    assert rows == [
        [
            "student",
            "name",
            "straight (10)",
            "straight attempts",
            "square (10)",
            "square attempts",
            "total",
            "percent",
        ],
        ["han", "han", "", "0", "", "0", "0", ""],
        ["li", "李雷", "5", "1", "5", "2", "10", "50"],
    ]
    services.rules.set("straight", Rules(weight=3), Signature(START, "ros", "test"))
    services.rules.set("square", replace(late, weight=0), Signature(START, "ros", "test"))
    assert table(client.get(URL, headers=school.as_("ta")))[2][-2:] == ["10", "50"]
    services.rules.set("square", replace(late, weight=1), Signature(START, "ros", "test"))
    graded(b"good good", student="", assignment="straight", headers=school.as_("li"))
    assert table(client.get(URL, headers=school.as_("ta")))[2][-2:] == ["15", "87.5"]


def test_canvas(client: httpx.Client, graded: Callable[..., str], school: Any, services: Services) -> None:
    graded(b"good", student="", headers=school.as_("li"))
    response = client.get(URL, params={"format": "canvas", "lang": "en"}, headers=school.as_("ta"))
    assert response.content.startswith(
        b"\xef\xbb\xbfStudent,ID,"
    )  # Canvas reads a marked first cell, not a quoted one
    assert table(response) == [
        [*HEAD, "Exercise straight [straight]", "Exercise square [square]"],
        ["    Points Possible", "", "", "", "", "10", "10"],
        ["han", "", "han", "han", "", "", ""],
        ["li", "", "li", "li", "", "", "5"],
    ]


def test_without_courses_everybody_who_handed_in(client: httpx.Client, graded: Callable[..., str]) -> None:
    graded(b"good", student="ann")
    rows = table(client.get(URL, headers={"Authorization": f"Bearer {TOKEN}"}))
    assert [row[0] for row in rows] == ["student", "ann"]


@pytest.mark.parametrize("name", ["=1+1", "+1", "-1", "@x", "\t=1", "\n=1", "＝1+1", "＋1", "－1", "＠x"])
def test_no_cell_is_a_formula(name: str) -> None:
    member = Member(course="c", id="1", name=name, role=Role.STUDENT)
    for text in (plain([member], [assignment()], {}, {}), canvas([member], [assignment()], {})):
        cells = [cell for row in csv.reader(io.StringIO(text.removeprefix("\ufeff"))) for cell in row]
        assert "'" + name in cells
        assert name not in cells


@given(st.lists(st.integers(0, 10**9), min_size=1, max_size=4))
def test_points_are_in_tables_to_the_cent(cents: list[int]) -> None:
    member = Member(course="c", id="1", name="Li", role=Role.STUDENT)
    published = [replace(assignment(), id=f"a{i}") for i in range(len(cents))]
    scores = {
        (member.id, one.id): progress(one.id, score / 100)
        for one, score in zip(published, cents, strict=True)
    }
    *points, total, _ = rows(plain([member], published, scores, {}))[1][2:]
    assert [Decimal(one) * 100 for one in points[::2]] == cents
    assert Decimal(total) * 100 == sum(cents)
    assert [Decimal(one) * 100 for one in rows(canvas([member], published, scores))[2][5:]] == cents


def progress(assignment_id: str, score: float) -> StudentProgress:
    return StudentProgress(
        student="1",
        assignment=assignment_id,
        attempts=1,
        best_score=score,
        max_score=score,
        best_submission="s",
        counted_score=score,
        counted_submission="s",
        latest_submission="s",
        state=SubmissionState.GRADED,
        verdict=GradeStatus.GRADED,
        last_activity_at=START,
        waits_for_person=False,
        shares=(1.0,),
    )


def rows(text: str) -> list[list[str]]:
    return list(csv.reader(io.StringIO(text.removeprefix("\ufeff"))))


def test_reports_for_other_graders(client: httpx.Client, graded: Callable[..., str], school: Any) -> None:
    url = graded(b"good", student="", headers=school.as_("li"))
    gradescope = client.get(url + "/gradescope.json", headers=school.as_("li")).json()
    assert (gradescope["score"], len(gradescope["tests"])) == (5.0, 2)
    prairielearn = client.get(url + "/prairielearn.json", headers=school.as_("li")).json()
    assert (prairielearn["gradable"], prairielearn["score"]) == (True, 0.5)


def test_hidden_items_are_in_no_other_format_either(
    client: httpx.Client, services: Services, graded: Callable[..., str], school: Any
) -> None:
    services.rules.set("square", Rules(hidden_items=("closed",)), Signature(START, "ros", "t"))
    url = graded(b"good good", student="", headers=school.as_("li"))
    for name in ("gradescope", "prairielearn"):
        assert len(client.get(f"{url}/{name}.json", headers=school.as_("li")).json()["tests"]) == 1
    counted = client.get(f"{url}/prairielearn.json", headers=school.as_("wang")).json()
    assert [one["name"] for one in counted["tests"]] == ["边数"]  # students see there whatever is listed
    assert (counted["score"], counted["message"], counted["output"]) == (1.0, "", "")
    whole = client.get(f"{url}/gradescope.json", headers=school.as_("wang")).json()
    assert {one["extra_data"]["id"]: one["visibility"] for one in whole["tests"]} == {
        "sides": "visible",
        "closed": "hidden",
    }
    assert whole["output"] == ""


def cells(response: httpx.Response, sheet: int = 0) -> list[list[object]]:
    assert response.status_code == 200
    book = CalamineWorkbook.from_filelike(io.BytesIO(response.content))
    return book.get_sheet_by_index(sheet).to_python()


def test_the_workbook_has_what_the_table_has(
    client: httpx.Client, services: Services, graded: Callable[..., str], school: Any
) -> None:
    li = RosterEntry(id="li", name="=1+1", sections=("A",))
    services.courses.import_roster("ros", [li], "test")
    graded(b"good", student="", headers=school.as_("li"))
    url, headers = "/api/v1/gradebook.xlsx", school.as_("ta")
    answer = client.get(url, headers=headers, params={"lang": "en"})
    assert cells(answer) == [
        ["Id", "Name", "Sections", "Exercise straight (10)", "Exercise square (10)", "Total", "Total %"],
        ["han", "han", "", "", "", 0.0, ""],
        ["li", "=1+1", "A", "", 5.0, 5.0, 25.0],
    ]
    assert len(cells(answer, 1)) == 3
    assert client.get(url, headers=headers, params={"lang": "en"}).content == answer.content
    assert [row[0] for row in cells(client.get(url, headers=headers, params={"section": "A"}))[1:]] == ["li"]


def test_a_registry_gets_one_column(client: httpx.Client, graded: Callable[..., str], school: Any) -> None:
    graded(b"good", student="", headers=school.as_("li"))
    url, headers = "/api/v1/gradebook.xlsx", school.as_("ta")
    wanted = {"layout": "registry", "column": "平时成绩"}
    assert cells(client.get(url, headers=headers, params=wanted)) == [
        ["学号或工号", "姓名", "平时成绩"],
        ["han", "han", ""],
        ["li", "li", 25.0],
    ]
    one = cells(client.get(url, headers=headers, params={**wanted, "assignment": "square"}))
    assert one[2] == ["li", "li", 5.0]
    unknown = client.get(url, headers=headers, params={**wanted, "assignment": "cube"})
    assert unknown.json()["code"] == "assignment_not_found"


def test_a_teachers_own_sheet_is_filled_in(
    client: httpx.Client, graded: Callable[..., str], school: Any
) -> None:
    graded(b"good", student="", headers=school.as_("li"))
    url, headers = "/api/v1/gradebook/fill", school.as_("ta")
    files = {"file": ("sheet.csv", "学号,平时,期末\nli,,80\nzhou,,70\n".encode())}
    answer = client.post(url, headers=headers, params={"column": "平时", "assignment": "square"}, files=files)
    assert cells(answer) == [["学号", "平时", "期末"], ["li", 5.0, 80.0], ["zhou", "", 70.0]]
    assert (answer.headers["x-filled-rows"], answer.headers["x-unknown-rows"]) == ("1", "1")
    wrong = client.post(url, headers=headers, params={"column": "总评"}, files=files)
    assert (wrong.status_code, wrong.json()["code"]) == (422, "invalid_sheet")
    assert "期末" in wrong.json()["detail"]


@given(st.integers(0, 10**6), st.integers(1, 10**6))
def test_a_percentage_is_rounded_as_people_do(cents: int, most: int) -> None:
    exact = Decimal(cents) * 1000 / Decimal(most)  # tenths of a percent
    assert percentage(cents / 100, most / 100) == float((exact + Decimal("0.5")) // 1) / 10
