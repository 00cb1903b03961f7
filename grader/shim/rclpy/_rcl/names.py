"""Rules for names: what rcl and rmw accept, where the first bad character is, how names are expanded."""

from __future__ import annotations

_LETTERS = frozenset("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ")
_DIGITS = frozenset("0123456789")
_WORD = _LETTERS | _DIGITS | {"_"}
_MAX_TOPIC = 247
_MAX_NAMESPACE = 245
_MAX_NODE = 255

Fault = tuple[str, int]
"""What is wrong, and the index of the character where it shows."""


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


def _token_fault(name: str, what: str, length_of: str, longest: int) -> Fault | None:
    repeated, digit = _repeated_slash(name), _digit_after_slash(name)
    if repeated and (not digit or repeated < digit):
        return f"{what} must not contain repeated '/'", repeated
    if digit:
        return f"{what} must not have a token that starts with a number", digit
    if len(name) > longest:
        return f"{length_of} should not exceed '{longest}'", longest - 1
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

    Raises:
        ValueError: the name, the node's name or the namespace is invalid, or a substitution is unknown.
    """
    if topic_name_fault(name) is not None:
        raise ValueError(f"topic name '{name}' is invalid: topic name is invalid, at "
                         "./src/rcl/expand_topic_name.c:70")  # fmt: skip
    if node_name_fault(node_name) is not None:
        raise ValueError(f"node name '{node_name}' is invalid: node name is invalid, at "
                         "./src/rcl/expand_topic_name.c:81")  # fmt: skip
    if namespace_fault(namespace) is not None:
        raise ValueError(f"node namespace '{namespace}' is invalid: node namespace is invalid, at "
                         "./src/rcl/expand_topic_name.c:92")  # fmt: skip
    prefix = namespace if namespace == "/" else namespace + "/"
    expanded = prefix + node_name + name[1:] if name[0] == "~" else name
    while "{" in expanded:
        before, _, rest = expanded.partition("{")
        key, _, after = rest.partition("}")
        value = {"node": node_name, "ns": namespace, "namespace": namespace}.get(key)
        if value is None:
            raise ValueError(
                f"topic name '{name}' is invalid: unknown substitution: {{{key}}}, at "
                "./src/rcl/expand_topic_name.c:176"
            )
        expanded = before + value + after
    return expanded if expanded[0] == "/" else prefix + expanded
