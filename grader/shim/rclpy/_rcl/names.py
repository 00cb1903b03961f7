"""Rules for names: what rcl and rmw accept, where the first bad character is, how names are expanded."""

from __future__ import annotations

from rclpy import _distro
from rclpy._rcl.errors import text_or_null, wrong_arguments

_LETTERS = frozenset("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ")
_DIGITS = frozenset("0123456789")
_WORD = _LETTERS | _DIGITS | {"_"}
_MAX_TOPIC = 247, "255U - 8U"  # the limit, and how upstream's macros print it
_MAX_NAMESPACE = 245, "RMW_NAMESPACE_MAX_NAME_LENGTH"
_MAX_NODE = 255

NAMESPACE_FAULTS = (
    "must not be empty",
    "must be absolute",
    "must not end with",
    "must not contain characters",
    "must not contain repeated",
    "must not have a token",
    "should not exceed",
)
NODE_FAULTS = ("must not be empty", "must not contain", "must not start with", "should not exceed")
"""What is wrong with a namespace and with a node's name, in the order of rmw's numbers, from 1 on."""

Fault = tuple[str, int]
"""What is wrong, and the index of the character where it shows."""


def named(name: object, kind: str, null: RuntimeError) -> str:
    """Return a name as the C module's function that validates its kind takes it; `null` is raised for None."""
    function = f"rclpy_get_validation_error_for_{kind}"
    text = text_or_null(name, lambda: wrong_arguments(function, "(arg0: str) -> object", name))
    if text is None:
        raise null
    return text


def _first_outside(name: str, allowed: frozenset[str]) -> int:
    return next((i for i, character in enumerate(name) if character not in allowed), -1)


def node_name_fault(name: str) -> Fault | None:
    """Return what is wrong with a node name, None when it is valid."""
    if not name:
        return "node name must not be empty", 0
    index = _first_outside(name, _WORD)
    if index >= 0:
        return "node name must not contain characters other than alphanumerics or '_'", index
    if name[0] in _DIGITS:
        return "node name must not start with a number", 0
    if len(name) > _MAX_NODE:
        return f"node name length should not exceed '{_MAX_NODE}'", _MAX_NODE - 1
    return None


def _repeated_slash(name: str) -> int:
    return name.find("//") + 1


def _digit_after_slash(name: str) -> int:
    return next((i for i in range(1, len(name)) if name[i - 1] == "/" and name[i] in _DIGITS), 0)


def namespace_fault(name: str) -> Fault | None:
    """Return what is wrong with a namespace, None when it is valid."""
    if name == "/":
        return None
    if not name:
        return "namespace must not be empty", 0
    if name[0] != "/":
        return "namespace must be absolute, it must lead with a '/'", 0
    if name[-1] == "/":
        return "namespace must not end with a '/', unless only a '/'", len(name) - 1
    index = _first_outside(name, _WORD | {"/"})
    if index >= 0:
        return "namespace must not contain characters other than alphanumerics, '_', or '/'", index
    return _token_fault(name, "namespace", "namespace", _MAX_NAMESPACE)


def full_topic_name_fault(name: str) -> Fault | None:
    """Return what is wrong with a fully qualified topic name, None when it is valid."""
    if not name:
        return "topic name must not be empty", 0
    if name[0] != "/":
        return "topic name must be absolute, it must lead with a '/'", 0
    if name[-1] == "/":
        return "topic name must not end with a '/'", len(name) - 1
    index = _first_outside(name, _WORD | {"/"})
    if index >= 0:
        return "topic name must not contain characters other than alphanumerics, '_', or '/'", index
    return _token_fault(name, "topic name", "topic length", _MAX_TOPIC)


def _token_fault(name: str, what: str, length_of: str, most: tuple[int, str]) -> Fault | None:
    repeated, digit = _repeated_slash(name), _digit_after_slash(name)
    if repeated and (not digit or repeated < digit):
        return f"{what} must not contain repeated '/'", repeated
    if digit:
        return f"{what} must not have a token that starts with a number", digit
    if len(name) > most[0]:
        return f"{length_of} should not exceed '{most[1]}'", most[0] - 1
    return None


def topic_name_fault(name: str) -> Fault | None:
    """Return what is wrong with a topic name as a script gives it (relative, ``~``, ``{node}``)."""
    if not name:
        return "topic name must not be empty string", 0
    if name[0] in _DIGITS:
        return "topic name token must not start with a number", 0
    if name[-1] == "/":
        return "topic name must not end with a forward slash", len(name) - 1
    fault = _character_fault(name)
    if fault is not None:
        return fault
    digit = _digit_after_slash(name)
    if name[0] == "~" and len(name) > 2 and name[1] != "/":
        return "topic name must not have a tilde '~' that is not followed by a forward slash '/'", 1
    if digit:
        return "topic name token must not start with a number", digit
    return None


def _character_fault(name: str) -> Fault | None:
    """Return the first character that must not stand where it is; ``{`` opens a substitution, ``}`` ends it."""
    opened = -1
    for i, character in enumerate(name):
        if opened >= 0 and character != "}":
            fault = _substitution_fault(character, first=i == opened + 1)
        else:
            fault = _plain_fault(character, first=i == 0, inside=opened >= 0)
            opened = i if character == "{" else -1
        if fault:
            return fault, i
    if opened >= 0:
        return "topic name must not have unmatched (unbalanced) curly braces '{}'", opened
    return None


def _substitution_fault(character: str, *, first: bool) -> str:
    if first and character in _DIGITS:
        return "substitution name must not start with a number"
    if character not in _WORD:
        return "substitution name must not contain characters other than alphanumerics or '_'"
    return ""


def _plain_fault(character: str, *, first: bool, inside: bool) -> str:
    if character == "}" and not inside:
        return "topic name must not have unmatched (unbalanced) curly braces '{}'"
    if character == "~" and not first:
        return "topic name must not have tilde '~' unless it is the first character"
    if character not in _WORD and character not in "/~{}":
        return "topic name must not contain characters other than alphanumerics, '_', '~', '{', or '}'"
    return ""


def expand(name: str, node_name: str, namespace: str) -> str:
    """Return the absolute form of a topic or service name.

    Raises ValueError: the name, the node's name or the namespace is invalid, or a substitution is unknown.
    """
    for what, text, fault, line in (
        ("topic name", name, topic_name_fault(name), 73),
        ("node name", node_name, node_name_fault(node_name), 84),
        ("node namespace", namespace, namespace_fault(namespace), 94),
    ):
        if fault is not None:
            reason = f"{what} is invalid" if _distro.chosen == _distro.HUMBLE else fault[0]
            raise ValueError(f"{what} '{text}' is invalid: {reason}, at ./src/rcl/expand_topic_name.c:{line}")
    prefix = namespace if namespace == "/" else namespace + "/"
    expanded = prefix + node_name + name[1:] if name[0] == "~" else name
    while "{" in expanded:
        before, _, rest = expanded.partition("{")
        key, _, after = rest.partition("}")
        value = {"node": node_name, "ns": namespace, "namespace": namespace}.get(key)
        if value is None:
            raise ValueError(
                f"topic name '{name}' is invalid: unknown substitution: {{{key}}}, at "
                "./src/rcl/expand_topic_name.c:163"
            )
        expanded = before + value + after
    return expanded if expanded[0] == "/" else prefix + expanded
