"""Generate the student side's interface data from the definitions in `interfaces/`.

    python tools/generate_interfaces.py [--check]

Reads every ``<package>/{msg,srv,action}/*.{msg,srv,action}`` and writes one text file, from which the shim
builds its message classes when a script first asks for them. Types get their IDL names and services and
actions their derived structures, as rosidl_adapter and rosidl_parser (Humble) do it; defaults and constants
become Python literals. `--check` writes nothing and fails when the file is out of date. Forms of a line:

    @package/kind/Name module_name     an interface
    =Structure                         a structure of it; its full name is package/kind/Structure
    !NAME type literal                 a constant
    name type [literal]                a field and its default
"""

import argparse
import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SOURCE = ROOT / "interfaces"
TARGET = ROOT / "grader" / "shim" / "rosidl_data" / "humble.txt"

IDL_NAMES = {
    "bool": "boolean",
    "byte": "octet",
    "char": "uint8",
    "float32": "float",
    "float64": "double",
    **{name: name for name in ("int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64")},
    "string": "string",
    "wstring": "wstring",
}
TYPE = re.compile(r"(?P<base>[A-Za-z][\w/]*)(?:<=(?P<bound>\d+))?(?P<array>\[(?:<=)?\d*\])?")
LINE = re.compile(r"(?P<type>\S+)\s+(?P<name>[A-Za-z]\w*)\s*(?:=\s*(?P<constant>.*?)|(?P<default>\S.*?))?\s*")
UUID = "unique_identifier_msgs/UUID"


class DefinitionError(Exception):
    """A definition file says something this generator does not understand."""


def idl_type(text: str, package: str) -> str:
    """Translate a type as a definition writes it, e.g. ``string<=22[<=3]`` -> ``string<22>[<=3]``."""
    match = TYPE.fullmatch(text)
    if match is None:
        raise DefinitionError(f"type {text!r}")
    base, bound, array = match["base"], match["bound"], match["array"] or ""
    if base in IDL_NAMES:
        return IDL_NAMES[base] + (f"<{bound}>" if bound else "") + array
    if base == "Header":
        return "std_msgs/msg/Header" + array
    owner, _, name = base.rpartition("/")
    # Goal, Result and Feedback of an action live beside it; every other structure is a message.
    kind = "action" if name.endswith(("_Goal", "_Result", "_Feedback")) else "msg"
    return f"{owner or package}/{kind}/{name}{array}"


def literal(idl: str, text: str) -> str:
    """Translate a default or constant into the Python literal rosidl_generator_py would write."""
    base, bracket, _ = idl.partition("[")
    if bracket:
        elements = ast.literal_eval(text.replace("true", "True").replace("false", "False"))
        return "[" + ", ".join(scalar(base, element) for element in elements) + "]"
    if base == "boolean":
        return scalar(base, {"true": True, "false": False, "1": True, "0": False}[text.lower()])
    if base.startswith(("string", "wstring")):
        return scalar(base, ast.literal_eval(text) if text[0] in "\"'" else text)
    return scalar(base, ast.literal_eval(text))


def scalar(base: str, value: object) -> str:
    """Return the literal of one value of a primitive type."""
    if base == "octet":
        return repr(bytes([int(str(value))]))
    return repr(float(str(value))) if base in ("float", "double") else repr(value)


def structure(name: str, text: str, package: str) -> Iterator[str]:
    """Yield the lines of one structure."""
    yield f"={name}"
    for raw in text.splitlines():
        line = raw if '"' in raw or "'" in raw else raw.partition("#")[0]
        if not line.strip():
            continue
        match = LINE.fullmatch(line.strip())
        if match is None:
            raise DefinitionError(f"line {raw!r}")
        idl = idl_type(match["type"], package)
        if match["constant"] is not None:
            yield f"!{match['name']} {idl} {literal(idl, match['constant'])}"
        elif match["default"] is not None:
            yield f"{match['name']} {idl} {literal(idl, match['default'])}"
        else:
            yield f"{match['name']} {idl}"


def structures(name: str, kind: str, text: str, package: str) -> Iterator[str]:
    """Yield the lines of all structures that an interface consists of."""
    parts = re.split(r"^---\s*$", text, flags=re.MULTILINE)
    if len(parts) != {"msg": 1, "srv": 2, "action": 3}[kind]:
        raise DefinitionError(f"{len(parts)} parts")
    if kind == "msg":
        yield from structure(name, text, package)
    elif kind == "srv":
        for suffix, part in zip(("Request", "Response"), parts, strict=True):
            yield from structure(f"{name}_{suffix}", part, package)
    else:
        for suffix, part in zip(("Goal", "Result", "Feedback"), parts, strict=True):
            yield from structure(f"{name}_{suffix}", part, package)
        for derived, fields in {
            f"{name}_SendGoal_Request": f"{UUID} goal_id\n{name}_Goal goal",
            f"{name}_SendGoal_Response": "bool accepted\nbuiltin_interfaces/Time stamp",
            f"{name}_GetResult_Request": f"{UUID} goal_id",
            f"{name}_GetResult_Response": f"int8 status\n{name}_Result result",
            f"{name}_FeedbackMessage": f"{UUID} goal_id\n{name}_Feedback feedback",
        }.items():
            yield from structure(derived, fields, package)


def module_name(name: str) -> str:
    """Return the name of the Python module of an interface without its underscore: ``twist_stamped``."""
    name = re.sub("(.)([A-Z][a-z]+)", r"\1_\2", name)
    return re.sub("([a-z0-9])([A-Z])", r"\1_\2", name).lower()


def generate(source: Path) -> str:
    """Return the whole data file.

    Raises:
        DefinitionError: naming the definition that is not understood.
    """
    lines = ["# Generated from interfaces/ by tools/generate_interfaces.py. Do not edit."]
    for path in sorted(p for kind in ("msg", "srv", "action") for p in source.glob(f"*/{kind}/*.{kind}")):
        package, kind = path.parts[-3], path.parts[-2]
        try:
            body = list(structures(path.stem, kind, path.read_text("utf-8"), package))
        except (DefinitionError, ValueError, SyntaxError, KeyError) as error:
            raise DefinitionError(f"{path}: {error}") from error
        lines += [f"@{package}/{kind}/{path.stem} {module_name(path.stem)}", *body]
    return "\n".join(lines) + "\n"


def main() -> int:
    """Write the data file, or with --check compare it."""
    parser = argparse.ArgumentParser(description="Generate the shim's interface data.")
    parser.add_argument("--check", action="store_true", help="only fail when the file is out of date")
    arguments = parser.parse_args()
    text = generate(SOURCE)
    if arguments.check:
        if not TARGET.exists() or TARGET.read_text("utf-8") != text:
            sys.stderr.write(f"{TARGET.relative_to(ROOT)} is out of date: run {Path(__file__).name}\n")
            return 1
        return 0
    TARGET.parent.mkdir(exist_ok=True)
    TARGET.write_text(text, "utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
