"""Launch files in XML and YAML: the elements that courses use, as the actions that a file in Python would make.

``arg``, ``let``, ``node`` (with ``param``, ``remap``, ``env``), ``include``, ``group``, ``push_ros_namespace``,
``set_env``, ``unset_env``, ``set_parameter``, ``set_remap``, ``timer``, ``log`` and ``executable``, with ``if``
and ``unless``.
"""

from __future__ import annotations

from functools import partial

from launch_ros.actions import Node, PushRosNamespace, SetParameter, SetRemap

from launch import actions, conditions
from launch._evaluation import LaunchDescription
from launch.frontend.parse_substitution import parse_substitution
from launch.launch_description_sources import frontends

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from typing import Any

    from rclpy._rcl.yaml import YamlEvent


class Element:
    """An element: its tag, its attributes as texts, and the elements in it."""

    def __init__(self, tag: str, attributes: dict[str, str], children: list[Element]) -> None:
        self.tag = tag.replace("-", "_")
        self.attributes = attributes
        self.children = children

    def text(self, name: str) -> Any:
        """Return an attribute with its substitutions, None where it is not there."""
        value = self.attributes.get(name)
        return None if value is None else parse_substitution(value)

    def required(self, name: str) -> Any:
        """Return an attribute that must be there. Raises AttributeError: it is not, as upstream says."""
        if name not in self.attributes:
            raise AttributeError(f"Attribute '{name}' of Entity '{self.tag}' not found")
        return self.text(name)

    def all(self, tag: str) -> Iterator[Element]:
        """Yield the elements of a kind in it."""
        return (child for child in self.children if child.tag == tag)


def read_xml(text: str) -> Element:
    """Return the root of a file in XML.

    Raises:
        xml.etree.ElementTree.ParseError: it is none.
    """
    from xml.etree import ElementTree

    def element(node: Any) -> Element:
        return Element(node.tag, dict(node.attrib), [element(child) for child in node])

    return element(ElementTree.fromstring(text))  # noqa: S314 - the student's own file, in the student's process


def read_yaml(text: str) -> Element:
    """Return the root of a file in YAML: a list of mappings, each with one element.

    Raises:
        YamlError, RuntimeError: it is none.
    """
    from rclpy._rcl.yaml import events

    root = _loaded(events(text))
    if not isinstance(root, dict) or len(root) != 1:
        raise RuntimeError("Expected only one root, with the key 'launch'")
    ((tag, inner),) = root.items()
    return _element(str(tag), inner)


def _loaded(events: Iterator[YamlEvent]) -> Any:
    """Return the next value of a stream of YAML: a text, a list or a mapping; None at the end of one."""
    from rclpy._rcl.yaml import MAPPING, SCALAR, SEQUENCE

    event = next(events, None)
    if event is None or event.kind not in (SCALAR, SEQUENCE, MAPPING):
        return None
    if event.kind == SCALAR:
        return event.text
    inner = []
    while (value := _loaded(events)) is not None:
        inner.append(value)
    return inner if event.kind == SEQUENCE else dict(zip(inner[::2], inner[1::2], strict=False))


def _element(tag: str, inner: Any) -> Element:
    attributes: dict[str, str] = {}
    children: list[Element] = []
    if isinstance(inner, list):
        for element in inner:
            children += [_element(str(name), value) for name, value in element.items()]
    elif isinstance(inner, dict):
        for name, value in inner.items():
            if name == "children":
                children += _element("", value).children
            elif isinstance(value, list):
                children += [_element(str(name), entry) for entry in value]
            else:
                attributes[str(name)] = str(value)
    return Element(tag, attributes, children)


def description(root: Element) -> LaunchDescription:
    """Return what a file describes. Raises RuntimeError: an element is not known here."""
    return LaunchDescription([_action(child) for child in root.children])


def _action(element: Element) -> Any:
    make = _ACTIONS.get(element.tag)
    if make is None:
        raise RuntimeError(f"Unrecognized entity of the type: {element.tag}")
    options: dict[str, Any] = {}
    if "if" in element.attributes:
        options["condition"] = conditions.IfCondition(element.text("if"))
    elif "unless" in element.attributes:
        options["condition"] = conditions.UnlessCondition(element.text("unless"))
    return make(element, options)


def _arg(element: Element, options: dict[str, Any]) -> Any:
    if "value" in element.attributes:  # as of ROS 1, and in an include
        return _let(element, options)
    return actions.DeclareLaunchArgument(
        element.attributes["name"], default_value=element.text("default"), **options
    )


def _let(element: Element, options: dict[str, Any]) -> Any:
    return actions.SetLaunchConfiguration(element.required("name"), element.required("value"), **options)


def _node(element: Element, options: dict[str, Any]) -> Any:
    parameters = [_parameter(param) for param in element.all("param")]
    remappings = [(remap.required("from"), remap.required("to")) for remap in element.all("remap")]
    environment = {variable.attributes["name"]: variable.required("value") for variable in element.all("env")}
    return Node(
        package=element.required("pkg"),
        executable=element.required("exec"),
        name=element.text("name"),
        namespace=element.text("namespace"),
        arguments=_words(element.attributes.get("args", "")),
        ros_arguments=_words(element.attributes.get("ros_args", "")) or None,
        parameters=parameters or None,
        remappings=remappings or None,
        additional_env=environment or None,
        output=element.attributes.get("output", "log"),
        **options,
    )


def _words(text: str) -> list[Any]:
    import shlex

    return [parse_substitution(word) for word in shlex.split(text)]


def _parameter(element: Element) -> Any:
    if "from" in element.attributes:
        return element.text("from")
    return {element.attributes["name"]: _value(element)}


def _value(element: Element) -> Any:
    nested = list(element.all("param"))
    if nested:
        return {child.attributes["name"]: _value(child) for child in nested}
    return element.required("value")


def _include(element: Element, options: dict[str, Any]) -> Any:
    values = [
        (argument.required("name"), argument.required("value"))
        for argument in (*element.all("arg"), *element.all("let"))
    ]
    return actions.IncludeLaunchDescription(element.required("file"), launch_arguments=values, **options)


def _group(element: Element, options: dict[str, Any]) -> Any:
    scoped = element.attributes.get("scoped", "true").lower() != "false"
    return actions.GroupAction([_action(child) for child in element.children], scoped=scoped, **options)


def _namespace(element: Element, options: dict[str, Any]) -> Any:
    return PushRosNamespace(element.required("namespace"), **options)


def _set_parameter(element: Element, options: dict[str, Any]) -> Any:
    return SetParameter(element.required("name"), element.required("value"), **options)


def _set_remap(element: Element, options: dict[str, Any]) -> Any:
    return SetRemap(element.required("from"), element.required("to"), **options)


def _timer(element: Element, options: dict[str, Any]) -> Any:
    inner = [_action(child) for child in element.children]
    return actions.TimerAction(period=float(element.attributes["period"]), actions=inner, **options)


_ACTIONS: dict[str, Callable[[Element, dict[str, Any]], Any]] = {
    "arg": _arg,
    "let": _let,
    "node": _node,
    "include": _include,
    "group": _group,
    "push_ros_namespace": _namespace,
    "set_parameter": _set_parameter,
    "set_remap": _set_remap,
    "set_env": lambda element, options: actions.SetEnvironmentVariable(
        element.required("name"), element.required("value"), **options
    ),
    "unset_env": lambda element, options: actions.UnsetEnvironmentVariable(
        element.required("name"), **options
    ),
    "timer": _timer,
    "log": lambda element, options: actions.LogInfo(msg=element.required("message"), **options),
    "executable": lambda element, options: actions.ExecuteProcess(
        cmd=_words(element.attributes["cmd"]), **options
    ),
}

frontends["xml"] = lambda text: partial(description, read_xml(text))
frontends["yaml"] = lambda text: partial(description, read_yaml(text))
