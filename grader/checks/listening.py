"""Mistakes of scripts, or nodes of a launch, that wait for what nobody sends: a topic, or a service's answer."""

import difflib
from collections.abc import Iterable

from grader.checks.measure import Mistake, mistake
from grader.contracts.assignment import ROBOT_TOPICS, World
from grader.contracts.outcome import Endpoint
from grader.contracts.scoring import Run

TURTLE = "/turtle1"
TURTLE_TOPICS = ("pose", "color_sensor")
WINDOW_SERVICES = {
    "/clear": "std_srvs/srv/Empty",
    "/reset": "std_srvs/srv/Empty",
    "/spawn": "turtlesim/srv/Spawn",
    "/kill": "turtlesim/srv/Kill",
}
TURTLE_SERVICES = {
    "set_pen": "turtlesim/srv/SetPen",
    "teleport_absolute": "turtlesim/srv/TeleportAbsolute",
    "teleport_relative": "turtlesim/srv/TeleportRelative",
}
"""The services to which a client's name is compared. Those of turtlesim's parameters are left out."""

_OF_ROS = ("/clock", "/parameter_events", "/rosout", "/tf_static")
_OF_PARAMETERS = "rcl_interfaces/"
_SIMILARITY = 0.75
_MOST_NAMED = 6


def waits_in_vain(run: Run, world: World, *, surely: bool = False) -> Mistake | None:
    """Recognise what a script that sent no command and went on to its end waits for, if nobody can ever send it.

    `surely`: report only what is certain: a service, or a topic whose name is nearly right.
    """
    return _unanswered_client(run, world) or _silent_topic(run, world, surely=surely)


def _unanswered_client(run: Run, world: World) -> Mistake | None:
    """Recognise a client of a service that nobody offers."""
    offered = {endpoint.name: endpoint.type for endpoint in _of_kind(run, "service")} | services_of(world)
    for client in _not_of_spawned(run, _of_kind(run, "client")):
        if "/_action/" in client.name or client.type.startswith(_OF_PARAMETERS):
            continue
        if client.name not in offered:
            return mistake("service_nowhere", service=client.name, services=_listed(client.name, offered))
        if offered[client.name] != client.type:
            wanted = offered[client.name]
            return mistake("other_type", name=client.name, type=client.type, wanted=wanted)
    return None


def _silent_topic(run: Run, world: World, *, surely: bool) -> Mistake | None:
    """Recognise a subscription, in the node that commands the car, to a topic that nobody publishes."""
    publishers = [endpoint for endpoint in _of_kind(run, "publisher") if endpoint.name not in _OF_ROS]
    commanding = {publisher.node for publisher in publishers if publisher.name == world.cmd_vel_topic}
    own = {publisher.name: publisher.type for publisher in publishers}
    published = (set(own) | set(topics_of(world))) - {world.cmd_vel_topic}
    heard = [
        endpoint
        for endpoint in _of_kind(run, "subscription")
        if endpoint.name not in (*_OF_ROS, world.cmd_vel_topic) and "/_action/" not in endpoint.name
    ]
    concerned = [endpoint for endpoint in _not_of_spawned(run, heard) if endpoint.node in commanding]
    for endpoint in concerned:
        if (
            endpoint.name in own
            and endpoint.name not in topics_of(world)
            and own[endpoint.name] != endpoint.type
        ):
            return mistake(
                "types_differ", topic=endpoint.name, published=own[endpoint.name], heard=endpoint.type
            )
    silent = [endpoint for endpoint in concerned if endpoint.name not in published]
    near = [endpoint for endpoint in silent if _near(endpoint.name, published)]
    if not near and (surely or not silent or len(silent) < len(concerned)):
        return None
    topic = (near or silent)[0].name
    return mistake("topic_nowhere", topic=topic, topics=_listed(topic, published))


def _of_kind(run: Run, kind: str) -> list[Endpoint]:
    return [endpoint for endpoint in run.outcome.endpoints if endpoint.kind == kind]


def topics_of(world: World) -> tuple[str, ...]:
    """Return the topics that a world publishes, without those of actions."""
    if world.kind == "robot":
        return tuple(world.topics.get(name, name) for name in ROBOT_TOPICS)
    odometry = ("/odom", "/tf") if world.odometry else ()
    return (*(f"{TURTLE}/{name}" for name in TURTLE_TOPICS), *odometry)


def services_of(world: World) -> dict[str, str]:
    """Return the services that a world offers, each with its type; none of actions and parameters."""
    if world.kind == "robot":
        return {}
    return WINDOW_SERVICES | {f"{TURTLE}/{name}": kind for name, kind in TURTLE_SERVICES.items()}


def _not_of_spawned(run: Run, endpoints: list[Endpoint]) -> list[Endpoint]:
    """Leave out endpoints that may belong to a turtle that the script has spawned."""
    if not _has_spawned(run):
        return endpoints
    names = (*TURTLE_TOPICS, *TURTLE_SERVICES)
    return [endpoint for endpoint in endpoints if endpoint.name.rpartition("/")[2] not in names]


def _has_spawned(run: Run) -> bool:
    return any(
        endpoint.type == "turtlesim/srv/Spawn" and endpoint.count for endpoint in _of_kind(run, "client")
    )


def _listed(name: str, known: Iterable[str]) -> str:
    """Return the known names, those first that were probably meant."""
    near = _near(name, known)
    return ", ".join([*near, *sorted(set(known) - set(near))][:_MOST_NAMED]) or "—"


def _near(name: str, known: Iterable[str]) -> list[str]:
    """Return the known names that were probably meant: the same last part, or similar letters."""
    names = sorted(known)
    same_end = [each for each in names if each.rpartition("/")[2].lower() == name.rpartition("/")[2].lower()]
    return same_end or difflib.get_close_matches(name, names, 1, _SIMILARITY)
