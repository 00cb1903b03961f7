"""The interfaces that an assignment brings along: what is read, and what is refused with which words."""

import re
from pathlib import Path

import pytest

from grader.catalog import Catalog
from grader.catalog.cache import AssignmentCache, AssignmentMemory
from grader.catalog.interfaces import MAX_FILES, read_interfaces
from grader.contracts.errors import AssignmentError

SPEC = """\
id: demo
version: 1
order: 1
title: {zh: 演示, en: Demo}
brief: {zh: 做, en: Do}
check: conversation
steps:
  - {id: asked, call: /add, type: my_pkg/srv/Add, values: {a: 1}}
items:
  - {id: answered, title: {zh: 服务, en: Service}, points: 100, expect: [{answer: asked}]}
"""
GOOD = {
    "my_pkg/msg/Mark.msg": "# a point with a name\nstring<=8 name\ngeometry_msgs/Point at\nfloat32[] heights\n",
    "my_pkg/msg/Path.msg": "Mark[] marks\nuint8 OPEN=0\n",
    "my_pkg/srv/Add.srv": "int64 a\nint64 b 2\n---\nint64 sum\nPath path\n",
    "my_pkg/action/Go.action": "Mark to\n---\nbool there\n---\nfloat64 left_m\n",
    "my_pkg/package.xml": "<package/>",
    "my_pkg/CMakeLists.txt": "rosidl_generate_interfaces()",
    ".DS_Store": "",
}


def place(root: Path, files: dict[str, str]) -> Path:
    """Write an assignment that brings along `files`; return its folder."""
    folder = root / "demo"
    folder.mkdir(exist_ok=True)
    (folder / "assignment.yaml").write_text(SPEC, "utf-8")
    for name, text in files.items():
        path = folder / "interfaces" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8")
    return folder


def test_interfaces_are_read_with_the_assignment(tmp_path: Path) -> None:
    place(tmp_path, GOOD)
    interfaces = Catalog(tmp_path).get("demo").interfaces
    assert [each.name for each in interfaces] == [
        "my_pkg/action/Go",
        "my_pkg/msg/Mark",
        "my_pkg/msg/Path",
        "my_pkg/srv/Add",
    ]
    assert interfaces[1].lines.split("\n") == [
        "my_pkg/msg/Mark mark",
        "=Mark",
        "name string<8>",
        "at geometry_msgs/msg/Point",
        "heights float[]",
    ]


@pytest.mark.parametrize(
    ("name", "text", "line", "words"),
    [
        ("my_pkg/msg/Mark.msg", "int8 x\nint8 y\nint8 z 300", 3, "no value of type int8"),
        ("my_pkg/msg/Mark.msg", "int8 x\n\nMarker m", 3, "no message my_pkg/Marker"),
        ("my_pkg/msg/Mark.msg", "Header h", 1, "write std_msgs/Header"),
        ("my_pkg/msg/Mark.msg", "geometry_msgs/Twits t", 1, "no message geometry_msgs/Twits"),
        ("my_pkg/msg/Mark.msg", "int8 x\nPath[] p", 2, "my_pkg/Mark contains itself"),
        ("my_pkg/msg/Mark.msg", "int8 x\nMark m", 2, "my_pkg/Mark contains itself"),
        ("my_pkg/msg/Mark.msg", "int8 x\nfloat64[7501] y", 2, "more than 60000 bytes"),
        ("my_pkg/msg/Mark.msg", "int8[999999999] y", 1, "more than 60000 bytes"),
        ("my_pkg/msg/Mark.msg", "#" * 16_385, 1, "more than 16384 bytes"),
        ("my_pkg/srv/Add.srv", "int64 a", 1, "2 parts"),
        ("my_pkg/srv/Add.msg", "", 1, "only <package>/msg/Name.msg"),
        ("my_pkg/mark.msg", "", 1, "only <package>/msg/Name.msg"),
        ("my_pkg/msg/mark.msg", "", 1, "only <package>/msg/Name.msg"),
        ("My/msg/Mark.msg", "", 1, "only <package>/msg/Name.msg"),
        ("std_msgs/msg/Text.msg", "string data", 1, "one of ROS's own"),
    ],
)
def test_what_would_not_build_is_refused_by_file_and_line(
    tmp_path: Path, name: str, text: str, line: int, words: str
) -> None:
    folder = place(tmp_path, {**GOOD, name: text})
    with pytest.raises(AssignmentError) as refusal:
        Catalog(tmp_path).get("demo")
    told = [each for each in str(refusal.value).splitlines() if words in each]
    assert told[0].startswith(f"{folder / 'interfaces' / name}:{line}: "), str(refusal.value)
    assert re.search(r"[\u4e00-\u9fff]{2}", refusal.value.message_in("zh"))


def test_arrays_of_arrays_are_too_large_as_well(tmp_path: Path) -> None:
    levels = {f"my_pkg/msg/L{i}.msg": f"L{i + 1}[100] below" for i in range(5)}
    place(tmp_path, {**GOOD, **levels, "my_pkg/msg/L5.msg": "int8 x"})
    with pytest.raises(AssignmentError, match="more than 60000 bytes"):
        Catalog(tmp_path).get("demo")


def test_their_number_is_bounded(tmp_path: Path) -> None:
    folder = place(tmp_path, {f"my_pkg/msg/M{i}.msg": "int8 x" for i in range(MAX_FILES + 1)})
    with pytest.raises(AssignmentError, match="more than 64"):
        read_interfaces(folder)


def test_not_utf8_is_refused(tmp_path: Path) -> None:
    folder = place(tmp_path, GOOD)
    (folder / "interfaces/my_pkg/msg/Mark.msg").write_bytes("# 标记\nint8 x".encode("gbk"))
    with pytest.raises(AssignmentError, match=r"Mark\.msg:1: .*save it as UTF-8"):
        read_interfaces(folder)


@pytest.mark.parametrize(
    ("old", "new", "line", "words"),
    [
        ("my_pkg/srv/Add", "my_pkg/srv/Sub", 8, "there is no type 'my_pkg/srv/Sub'"),
        ("{a: 1}", "{c: 1}", 8, "no field 'c'; there are: a, b"),
    ],
)
def test_calls_must_fit_their_services(tmp_path: Path, old: str, new: str, line: int, words: str) -> None:
    spec = place(tmp_path, GOOD) / "assignment.yaml"
    spec.write_text(SPEC.replace(old, new), "utf-8")
    with pytest.raises(AssignmentError) as refusal:
        Catalog(tmp_path).get("demo")
    assert f"assignment.yaml:{line}: steps.0." in str(refusal.value)
    assert words in str(refusal.value)


@pytest.mark.parametrize("on_disk", [True, False])
def test_an_edited_interface_is_seen(tmp_path: Path, on_disk: bool) -> None:
    folder = place(tmp_path, GOOD)
    cache = AssignmentCache(tmp_path / "cache") if on_disk else AssignmentMemory()
    before = Catalog(tmp_path, cache).get("demo")
    assert cache.find(folder / "assignment.yaml") == before
    (folder / "interfaces/my_pkg/msg/Mark.msg").write_text("int8 other")
    after = Catalog(tmp_path, cache).get("demo")
    assert after.interfaces != before.interfaces
    (folder / "interfaces/my_pkg/msg/Mark.msg").write_text("oops")
    with pytest.raises(AssignmentError, match="a type and a name"):
        Catalog(tmp_path, cache).get("demo")
