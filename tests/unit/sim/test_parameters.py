"""/turtlesim's parameters, as rclcpp answers for them."""

from typing import Any

import pytest

from grader.sim.driving import Car
from grader.sim.parameters import SERVICES, Parameters
from tests.fakes.jail import Script
from tests.unit.sim.student import TYPES, Student, run

BOOL, INTEGER, STRING = 1, 2, 4


def integer(name: str, value: int) -> dict[str, Any]:
    return {"name": name, "value": {"type": INTEGER, "integer_value": value}}


def test_the_backgrounds_are_turtlesims() -> None:
    asked = {"names": ["background_r", "background_g", "background_b"]}
    values = Parameters().answer("get_parameters", asked)["values"]
    assert [value["integer_value"] for value in values] == [69, 86, 255]
    assert Parameters().answer("get_parameter_types", asked) == {"types": bytes([INTEGER] * 3)}
    (red, *_) = Parameters().answer("describe_parameters", asked)["descriptors"]
    assert red["description"] == "Red channel of the background color"
    assert red["integer_range"] == [{"from_value": 0, "to_value": 255, "step": 1}]


def test_jazzys_turtlesim_has_two_more() -> None:
    of_jazzy = Parameters("jazzy")
    asked = {"names": ["holonomic", "start_type_description_service"]}
    assert [value["bool_value"] for value in of_jazzy.answer("get_parameters", asked)["values"]] == [
        False,
        True,
    ]
    assert Parameters().answer("get_parameters", asked) == {"values": []}
    wanted = {"name": "holonomic", "value": {"type": BOOL, "bool_value": True}}
    assert of_jazzy.answer("set_parameters", {"parameters": [wanted]}) == {"results": [{"successful": True}]}
    names = of_jazzy.answer("list_parameters", {"prefixes": [], "depth": 0})["result"]["names"]
    assert names == sorted(names)
    assert len(names) == 10


@pytest.mark.parametrize(
    ("prefixes", "depth", "count"),
    [([], 0, 8), ([], 1, 4), (["background_r"], 0, 1), (["qos_overrides"], 0, 4), (["qos_overrides"], 1, 0)],
)
def test_names_are_listed_by_prefix_and_depth(prefixes: list[str], depth: int, count: int) -> None:
    result = Parameters().answer("list_parameters", {"prefixes": prefixes, "depth": depth})["result"]
    assert len(result["names"]) == count
    assert result["names"] == sorted(result["names"])


@pytest.mark.parametrize(
    ("parameter", "reason"),
    [
        (integer("background_r", 256), "Parameter {background_r} doesn't comply with integer range."),
        (integer("colour", 1), "parameter 'colour' cannot be set because it was not declared"),
        (
            integer("qos_overrides./parameter_events.publisher.depth", 1),
            "parameter 'qos_overrides./parameter_events.publisher.depth' cannot be set because it is read-only",
        ),
        (
            {"name": "background_r", "value": {"type": STRING, "string_value": "red"}},
            "Wrong parameter type, parameter {background_r} is of type {integer}, setting it to {string} is not"
            " allowed.",
        ),
    ],
)
def test_what_cannot_be_set_is_refused_in_rclcpps_words(parameter: dict[str, Any], reason: str) -> None:
    parameters = Parameters()
    refused = {"successful": False, "reason": reason}
    given = {"parameters": [integer("background_g", 1), parameter]}
    assert parameters.answer("set_parameters_atomically", given)["result"] == refused
    asked = {"names": ["background_g"]}
    assert parameters.answer("get_parameters", asked)["values"][0]["integer_value"] == 86
    assert parameters.answer("set_parameters", given)["results"] == [{"successful": True}, refused]
    assert parameters.answer("get_parameters", asked)["values"][0]["integer_value"] == 1


def test_one_unknown_name_makes_the_answer_empty() -> None:
    asked = {"names": ["background_r", "colour"]}
    assert Parameters().answer("get_parameters", asked) == {"values": []}
    assert Parameters().answer("describe_parameters", asked) == {"descriptors": []}


def test_scripts_reach_them(car: Car) -> None:
    student = Student()
    for name, kind in SERVICES.items():
        TYPES[f"/turtlesim/{name}"] = kind

    def story() -> Script:
        done = yield from student.call("/turtlesim/set_parameters", parameters=[integer("background_r", 7)])
        assert done["results"] == [{"successful": True, "reason": ""}]
        got = yield from student.call("/turtlesim/get_parameters", names=["background_r"])
        assert got["values"][0]["integer_value"] == 7

    run(car, student, story())
