"""What the hints take for the topics and services of a world is what the world has."""

import pytest

from grader.checks.listening import services_of, topics_of
from grader.contracts.assignment import World
from grader.sim.driving import Car
from grader.sim.recorder import Recorder
from grader.sim.turtle import Turtle
from grader.sim.turtle_world import TurtleWorld


@pytest.mark.parametrize("odometry", [False, True])
def test_turtlesims_names_are_those_of_the_simulated_one(odometry: bool) -> None:
    world = World(odometry=odometry, cmd_vel_topic="/cmd_vel")
    car = Car()
    graph = TurtleWorld(Turtle(car, Recorder(), world, 0), world, 0).graph()
    car.close()
    topics = {name for name, _ in graph["publishes"] if "/_action/" not in name}
    services = {
        name: kind
        for name, kind in graph["services"]
        if "/_action/" not in name and not kind.startswith("rcl_interfaces/")
    }
    assert topics == set(topics_of(world))
    assert services == services_of(world)
