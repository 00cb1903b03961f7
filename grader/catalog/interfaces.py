"""The interfaces that an assignment brings along: ``interfaces/<package>/{msg,srv,action}/Name.*`` in its folder.

They are read when the assignment is, so that a script can import them and the world can speak them. What would not
build at home is refused here, with file, line and fix; so is what is too large to be a message.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache, partial
from pathlib import Path, PurePath, PurePosixPath
from typing import Final

from grader.catalog.definitions import INTERFACE, PACKAGE, PARTS, DefinitionError, meant_type, translated
from grader.catalog.files import INTERFACES, interface_files
from grader.catalog.misfits import refusals
from grader.contracts.assignment import InterfaceDefinition
from grader.contracts.text import Text, trouble
from grader.formats.interfaces import standard_entries, structures_of

MAX_FILES: Final = 64
MAX_FILE_BYTES: Final = 16_384
MAX_MESSAGE_BYTES: Final = 60_000
"""Bound on a message whose texts and sequences are empty; a larger one would fit in no frame."""

_WIDTHS: Final = {"boolean": 1, "octet": 1, "float": 4, "double": 8, "string": 4, "wstring": 4} | {
    f"{sign}int{bits}": bits // 8 for sign in ("", "u") for bits in (8, 16, 32, 64)
}
_FORM: Final = Text(
    zh="只放 <包>/msg/Name.msg、<包>/srv/Name.srv、<包>/action/Name.action：改名或移走",
    en="only <package>/msg/Name.msg, <package>/srv/Name.srv and <package>/action/Name.action belong here; "
    "rename or move it",
)
_TOO_MANY: Final = Text(
    zh=f"接口文件超过 {MAX_FILES} 个：删掉不用的", en=f"more than {MAX_FILES} interfaces; remove unused ones"
)
_TOO_LARGE: Final = Text(
    zh=f"文件超过 {MAX_FILE_BYTES} 字节：缩短",
    en=f"the file has more than {MAX_FILE_BYTES} bytes; shorten it",
)
_NOT_UTF8: Final = Text(zh="不是 UTF-8 编码：请另存为 UTF-8", en="this is not UTF-8; save it as UTF-8")
_OF_ROS: Final = Text(
    zh="这个包是 ROS 自带的，不能改：换一个包名",
    en="this package is one of ROS's own and stays as it is; choose another name",
)
Fields = Mapping[str, str]
"""The fields of a structure: name -> type."""
_Found = Mapping[str, tuple[str, str, InterfaceDefinition]]
"""By name: where a definition stands, its text, and what it says."""

_Misfit = tuple[str, Text]  # the field it is about, and what is wrong


def read_interfaces(folder: Path) -> tuple[InterfaceDefinition, ...]:
    """Return the interfaces that the assignment in `folder` brings along.

    Raises AssignmentError: naming file, line and fix of the first problem of each file.
    """
    files = interface_files(folder)
    if not files:
        return ()
    if len(files) > MAX_FILES:
        raise refusals([(str(folder / INTERFACES), _TOO_MANY)])
    return _defined(
        [(str(path), path.relative_to(folder / INTERFACES), partial(_text, path)) for path in files]
    )


def own_interfaces(texts: Mapping[str, str]) -> tuple[InterfaceDefinition, ...]:
    """Return interfaces that a handed-in package brings along, by place (``my_msgs/msg/Name.msg``) and text.

    Raises as `read_interfaces`; the files are the student's.
    """
    if len(texts) > MAX_FILES:
        raise refusals([(INTERFACES, _TOO_MANY)])
    return _defined([(place, PurePosixPath(place), partial(str, text)) for place, text in texts.items()])


def _defined(files: Iterable[tuple[str, PurePath, Callable[[], str]]]) -> tuple[InterfaceDefinition, ...]:
    """Return what files define, given by what they are called, their places below the root, and their texts."""
    definitions: dict[str, tuple[str, str, InterfaceDefinition]] = {}
    problems = []
    for shown, place, text in files:
        try:
            definition, content = _definition(place, text)
            definitions[definition.name] = shown, content, definition
        except DefinitionError as error:
            problems.append((f"{shown}:{error.line}", error.told))
    if not problems:
        problems = list(_misfits(definitions))
    if problems:
        raise refusals(problems)
    return tuple(definition for *_, definition in definitions.values())


def _definition(place: PurePath, read: Callable[[], str]) -> tuple[InterfaceDefinition, str]:
    try:
        package, kind, _ = place.parts
    except ValueError:
        raise DefinitionError(1, _FORM) from None
    fits = PACKAGE.fullmatch(package) and INTERFACE.fullmatch(place.stem)
    if not fits or kind not in PARTS or place.suffix != f".{kind}":
        raise DefinitionError(1, _FORM)
    if any(name.startswith(f"{package}/") for name in standard_types()):
        raise DefinitionError(1, _OF_ROS)
    text = read()
    name = f"{package}/{kind}/{place.stem}"
    return InterfaceDefinition(name=name, lines=translated(package, kind, place.stem, text)), text


def _text(path: Path) -> str:
    try:
        if path.stat().st_size > MAX_FILE_BYTES:
            raise DefinitionError(1, _TOO_LARGE)
        return path.read_text("utf-8")
    except OSError as error:
        raise DefinitionError(1, trouble(error)) from None
    except UnicodeDecodeError:
        raise DefinitionError(1, _NOT_UTF8) from None


@cache
def standard_types() -> Mapping[str, Fields]:
    """Return the structures of ROS's own interfaces by their full names."""
    return _fields_of(standard_entries())


def types_of(interfaces: Iterable[InterfaceDefinition]) -> Mapping[str, Fields]:
    """Return the structures of `interfaces` by their full names."""
    return _fields_of(interface.lines for interface in interfaces)


def _fields_of(entries: Iterable[str]) -> Mapping[str, Fields]:
    return {
        name: {member[0]: member[1] for member in members}
        for entry in entries
        for name, members in structures_of(entry)
    }


def _misfits(found: _Found) -> Iterator[tuple[str, Text]]:
    """Yield what is wrong with the interfaces as a whole: unknown types, recursion, size."""
    types = {**standard_types(), **types_of(definition for *_, definition in found.values())}
    sizes: dict[str, int] = {}
    for place, text, definition in found.values():
        for name, fields in types_of([definition]).items():
            problem = _unknown(fields, types) or _recursion(name, types) or _size(name, types, sizes)
            if problem is not None:
                yield f"{place}:{_line(text, problem[0])}", problem[1]


def _line(text: str, field: str) -> int:
    """Return the number of the first line of a definition that declares the field; 1 if none does."""
    declaration = re.compile(rf"\s*\S+\s+{field}\b")
    return next((number for number, line in enumerate(text.splitlines(), 1) if declaration.match(line)), 1)


def _unknown(fields: Fields, known: Mapping[str, object]) -> _Misfit | None:
    for name, base in ((name, each.partition("[")[0]) for name, each in fields.items()):
        if "/" in base and base not in known:
            shown = base.replace("/msg/", "/")
            meant = meant_type(base)
            return name, Text(
                zh=f"没有消息 {shown}：" + (f"写成 {meant}" if meant else "检查拼写，或者补上它的 .msg 文件"),
                en=f"there is no message {shown}; "
                + (f"write {meant}" if meant else "check its spelling or add its .msg file"),
            )
    return None


def _recursion(name: str, known: Mapping[str, Fields]) -> _Misfit | None:
    """Return the field by which a structure contains itself, directly or through others; None if there is none."""
    for field, first in known[name].items():
        visited, waiting = set(), [first.partition("[")[0]]
        while waiting:
            base = waiting.pop()
            if base == name:
                shown = name.replace("/msg/", "/")
                return field, Text(
                    zh=f"{shown} 通过这个字段包含它自己：删掉这个字段",
                    en=f"by this field {shown} contains itself; remove the field",
                )
            if base not in visited:
                visited.add(base)
                waiting += [type_text.partition("[")[0] for type_text in known.get(base, {}).values()]
    return None


def _size(name: str, known: Mapping[str, Fields], sizes: dict[str, int]) -> _Misfit | None:
    """Return the largest field of a structure that is too large, unless a field's own type is that already."""
    fields = known[name]
    below = (_least_bytes(field.partition("[")[0], known, sizes) for field in fields.values() if "/" in field)
    if _least_bytes(name, known, sizes) <= MAX_MESSAGE_BYTES or max(below, default=0) > MAX_MESSAGE_BYTES:
        return None
    return max(fields, key=lambda field: _field_bytes(fields[field], known, sizes)), Text(
        zh=f"一条消息超过 {MAX_MESSAGE_BYTES} 字节：把定长数组改短，或改成变长数组 []",
        en=f"a message takes more than {MAX_MESSAGE_BYTES} bytes at least; shorten its arrays or write []",
    )


def _least_bytes(name: str, known: Mapping[str, Fields], sizes: dict[str, int]) -> int:
    """Return about how many bytes a message without recursion takes at least, padding left out."""
    if name not in sizes:
        sizes[name] = 1  # ends the recursion of a type that contains itself, which `_recursion` reports
        sizes[name] = (
            sum(_field_bytes(type_text, known, sizes) for type_text in known.get(name, {}).values()) or 1
        )
    return sizes[name]


def _field_bytes(field: str, known: Mapping[str, Fields], sizes: dict[str, int]) -> int:
    base, bracket, count = field.partition("[")
    if bracket and not count[:-1].isdigit():
        return _WIDTHS["string"]  # its length
    base = base.partition("<")[0]
    one = _least_bytes(base, known, sizes) if "/" in base else _WIDTHS[base]
    return one * int(count[:-1] or 1)
