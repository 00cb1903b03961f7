"""Taking a platform's people in (NRPS): adds only, seen before, whatever the platform says."""

from collections.abc import Callable
from typing import Any

import httpx
import pytest
from fastapi import FastAPI

from grader.contracts.errors import RefusedError
from grader.contracts.identity import Caller, Role, Seen
from grader.contracts.platform import Platform
from grader.outside.lti import roster
from grader.outside.lti.scores import PlatformChannel
from grader.outside.signin.channel import UnreachableError
from grader.use_cases import platform_people
from grader.use_cases.services import Services
from tests.fakes.provider import FakeProvider
from tests.unit.service.web.conftest import Browser
from tests.unit.service.web.test_platform_scores import add_platform, linked, moodle, signer
from tests.unit.service.web.test_platforms import open_activity, platform, ready

__all__ = ["linked", "moodle", "platform", "ready"]
LEARNER = "http://purl.imsglobal.org/vocab/lis/v2/membership#Learner"
TEACHER = "http://purl.imsglobal.org/vocab/lis/v2/membership#Instructor"


def listed(subject: str, number: str = "", name: str = "", **more: Any) -> dict[str, Any]:
    person = {"user_id": subject, "lis_person_sourcedid": number, "name": name, "roles": [LEARNER]}
    return {**person, "status": "Active", **more}


@pytest.fixture
def course(linked: Services, moodle: FakeProvider) -> tuple[Services, Platform]:
    """A course whose platform has said where it tells its people; `li` is known there as 3."""
    (known,) = linked.platforms.of_course("ros")
    linked.platforms.set_people_url(known.id, f"{moodle.address}/people?type=1")
    moodle.people, moodle.elsewhere = [[]], ""
    (known,) = linked.platforms.of_course("ros")
    return linked, known


def wang(services: Services) -> Caller:
    return Caller(course="ros", person="wang", role=Role.INSTRUCTOR)


def roster_of(services: Services) -> dict[str, tuple[str, Role]]:
    return {one.id: (one.name, one.role) for one in services.courses.members("ros")}


def test_students_who_are_missing_are_added_and_nobody_else_changes(
    course: tuple[Services, Platform], moodle: FakeProvider
) -> None:
    services, known = course
    before = roster_of(services)
    moodle.people = [
        [listed("3", "li", "Another Name"), listed("4", "20260001", "王小明", email="wang@example.edu")],
        [listed("5", "", "Nameless"), listed("6", "t9", "Teacher", roles=[TEACHER])],
        [listed("7", "WANG", "Not lowered"), listed("8", "g1", "Gone", status="Deleted"), "junk", {}],
        [
            listed("9", "20260002", given_name="Ada", family_name="L", roles=["Learner"]),
            listed("9", "20260002"),
        ],
    ]
    planned = platform_people.plan(services, wang(services), known.id)
    assert [(one.id, one.name, one.email) for one in planned.added] == [
        ("20260001", "王小明", "wang@example.edu"),
        ("20260002", "Ada L", None),
    ]
    assert (planned.known, planned.nameless, planned.others) == (2, ("Nameless",), 3)
    assert roster_of(services) == before
    platform_people.add(services, wang(services), known.id, Seen.one(planned.tag))
    new = {"20260001": ("王小明", Role.STUDENT), "20260002": ("Ada L", Role.STUDENT)}
    assert roster_of(services) == before | new
    again = platform_people.plan(services, wang(services), known.id)
    assert (again.added, again.known) == ((), 5)
    entries = services.audit.entries("ros", 10)
    assert [one.subject for one in entries if one.actor == "wang"][:2] == [
        "member 20260002",
        "member 20260001",
    ]


def test_what_was_seen_is_what_is_added(course: tuple[Services, Platform], moodle: FakeProvider) -> None:
    services, known = course
    moodle.people = [[listed("4", "20260001")]]
    planned = platform_people.plan(services, wang(services), known.id)
    moodle.people = [[listed("4", "20260001"), listed("5", "20260002")]]
    with pytest.raises(RefusedError, match="changed_meanwhile"):
        platform_people.add(services, wang(services), known.id, Seen.one(planned.tag))
    assert "20260001" not in roster_of(services)


def test_texts_that_fit_no_class_list_are_left_out(
    course: tuple[Services, Platform], moodle: FakeProvider
) -> None:
    services, known = course
    moodle.people = [[listed("4", "20260001", "x" * 900, email="no address"), listed("5", "bad id", "N")]]
    planned = platform_people.plan(services, wang(services), known.id)
    assert [(one.id, one.name, one.email) for one in planned.added] == [("20260001", "", None)]
    assert planned.nameless == ("N",)


def test_two_with_one_id_are_told_and_not_added(
    course: tuple[Services, Platform], moodle: FakeProvider
) -> None:
    services, known = course
    moodle.people = [
        [listed("4", "20260001", "A"), listed("5", "20260001", "B"), listed("6", "20260001", "C")]
    ]
    planned = platform_people.plan(services, wang(services), known.id)
    assert (planned.added, planned.nameless) == ((), ("A", "B", "C"))


def test_a_chinese_name_is_written_as_it_is_at_home(
    course: tuple[Services, Platform], moodle: FakeProvider
) -> None:
    services, known = course
    person = listed("4", "20260001", "小明 王", given_name="小明", family_name="王")
    moodle.people = [[person, listed("5", "20260002", "Ada L", given_name="Ada", family_name="L")]]
    planned = platform_people.plan(services, wang(services), known.id)
    assert [one.name for one in planned.added] == ["王小明", "Ada L"]


def pages_without_end(moodle: FakeProvider) -> None:
    moodle.people = [[listed(str(i), f"s{i}")] for i in range(roster.MOST_PAGES + 1)]


def too_many_people(moodle: FakeProvider) -> None:
    moodle.people = [[listed(str(i)) for i in range(1_000)] for _ in range(roster.MOST_PEOPLE // 1_000 + 1)]


def another_server(moodle: FakeProvider) -> None:
    moodle.people, moodle.elsewhere = [[], []], "http://127.0.0.2:1"


def no_list(moodle: FakeProvider) -> None:
    moodle.people = [{"not": "a list"}]


def down(moodle: FakeProvider) -> None:
    moodle.down = True


@pytest.mark.parametrize("spoil", [pages_without_end, too_many_people, another_server, no_list, down])
def test_a_platform_that_answers_otherwise_is_refused(
    course: tuple[Services, Platform], moodle: FakeProvider, spoil: Callable[[FakeProvider], None]
) -> None:
    services, known = course
    spoil(moodle)
    with pytest.raises(RefusedError, match="platform_people_refused"):
        platform_people.plan(services, wang(services), known.id)


def test_a_platform_in_a_private_network_is_not_asked(
    course: tuple[Services, Platform], moodle: FakeProvider
) -> None:
    _, known = course
    channel = PlatformChannel(signer, moodle.clock_s, private=False)
    with pytest.raises(UnreachableError, match="private network"):
        channel.people(known)


def test_only_the_courses_own_platform_is_asked(
    course: tuple[Services, Platform], moodle: FakeProvider
) -> None:
    services, known = course
    other = Caller(course="other", person="wang", role=Role.INSTRUCTOR)
    with pytest.raises(RefusedError, match="platform_not_found"):
        platform_people.plan(services, other, known.id)
    silent = add_platform(services, moodle, "https://canvas.example")
    with pytest.raises(RefusedError, match="platform_tells_nobody"):
        platform_people.plan(services, wang(services), silent.id)
    assert "/people" not in moodle.asked


def test_a_launch_says_where_people_are_told(
    client: httpx.Client, moodle: FakeProvider, ready: Services, platform: Platform
) -> None:
    where = "https://moodle.example.edu/mod/lti/services.php/CourseSection/2/bindings/1/memberships"
    for said, kept in (
        ({"context_memberships_url": where, "service_versions": ["2.0"]}, where),
        ("junk", where),
        ({"context_memberships_url": "http://10.0.0.1/x"}, where),
        ({"context_memberships_url": f"{where}?a=b"}, f"{where}?a=b"),
    ):
        assert open_activity(client, moodle, ready, **{roster.ROSTER_CLAIM: said}).status_code == 200
        (known,) = ready.platforms.of_course("ros")
        assert known.people_url == kept


def test_on_the_page_and_over_http(
    course: tuple[Services, Platform], moodle: FakeProvider, running: tuple[FastAPI, str],
    tokens: dict[str, str], client: httpx.Client,
) -> None:  # fmt: skip
    services, known = course
    running[0].state.services = services
    instructor = Browser(client)
    instructor.enter(token=tokens["wang"])
    moodle.people = [[listed("4", "20260001", "王小明"), listed("5", "20260002", "<b>Ada</b>")]]
    shown = instructor.post("/class/platforms/people", {"platform": known.id}, page="/class/platforms")
    assert shown.status_code == 200
    assert "王小明" in shown.text
    assert "<b>Ada" not in shown.text
    headers = {"Authorization": f"Bearer {tokens['wang']}"}
    address = f"/api/v1/course/platforms/{known.id}/people"
    told = client.get(address, headers=headers).json()
    assert [one["id"] for one in told["added"]] == ["20260001", "20260002"]
    refused = client.post(address, params={"plan": "another"}, headers=headers)
    assert (refused.status_code, refused.json()["type"].rpartition("/")[2]) == (412, "changed_meanwhile")
    done = client.post(address, params={"plan": told["plan"]}, headers=headers)
    assert (done.status_code, done.json()["added"]) == (200, told["added"])
    assert "20260002" in roster_of(services)
    nobody = instructor.post("/class/platforms/people", {"platform": known.id}, page="/class/platforms")
    assert "/class/platforms/people/add" not in nobody.text
    moodle.down = True
    failed = instructor.post("/class/platforms/people", {"platform": known.id}, page="/class/platforms")
    assert (failed.status_code, 'role="alert"' in failed.text) == (502, True)
