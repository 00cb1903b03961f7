"""The generated interface data is what its definitions say."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rclpy._interfaces.definitions import INTERFACES, parsed
from rclpy._interfaces.message_source import class_source
from rosbags.typesys import Stores, get_typestore

from grader.catalog.definitions import DefinitionError, translated

SCRIPT = Path(__file__).resolve().parents[3] / "tools" / "generate_interfaces.py"


def test_shipped_data_is_up_to_date() -> None:
    subprocess.run([sys.executable, SCRIPT, "--check"], check=True)


def test_definitions_equal_those_of_rosbags() -> None:
    """Compare field names, and which fields hold several elements, of every message rosbags knows."""
    oracle = get_typestore(Stores.ROS2_HUMBLE).fielddefs
    compared = 0
    for interface in INTERFACES.values():
        for structure in interface.structures():
            if structure.full_name not in oracle:
                continue
            compared += 1
            _, fields = oracle[structure.full_name]
            theirs = [(name, int(kind) in (3, 4)) for name, (kind, _) in fields]
            ours = [(field.name, field.is_nested) for field in structure.fields]
            assert ours == [f for f in theirs if f[0] != "structure_needs_at_least_one_member"]
    assert compared > 120


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("float64 x", "x double"),
        ("char c 100", "c uint8 100"),
        ("byte FATAL=50", "!FATAL octet b'2'"),
        ("string<=5[<=2] names", "names string<5>[<=2]"),
        ('string s "a # b"', "s string 'a # b'"),
        ("int32 x  # a comment", "x int32"),
        ("string name  # the robot's \"own\" name", "name string"),
        ("std_msgs/Header header", "header std_msgs/msg/Header"),
        ("Vector3[] v", "v here/msg/Vector3[]"),
        ("bool[2] flags [true, false]", "flags boolean[2] [True, False]"),
        ("float32 F=1", "!F float 1.0"),
        ("int8 LOW=-128", "!LOW int8 -128"),
        ("string WORD=a b", "!WORD string 'a b'"),
    ],
)
def test_lines(line: str, expected: str) -> None:
    assert translated("here", "msg", "X", line).split("\n") == ["here/msg/X x", "=X", expected]


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("float64", "write a type and a name"),
        ("float64[ x", "type 'float64['"),
        ("int8 x oops", "'oops' is not understood"),
        ("int8 x 128", "no value of type int8"),
        ("uint64 x -1", "no value of type uint64"),
        ("int32 x 1.5", "no value of type int32"),
        ("float32 x 1e39", "no value of type float"),
        ("string<=2 s 'abc'", "no value of type string<2>"),
        ("int8[2] x [1]", "2 elements"),
        ("int8[<=2] x [1, 2, 3]", "2 elements"),
        ("int8[] x 3", "as [1, 2, 3]"),
        ("int8 x " + "(" * 5000, "is not understood"),
        ("Vector3 v 1", "no default"),
        ("Vector3 V=1", "change its type"),
        ("int8 low=1", "capital letters"),
        ("int8 Low", "small letters"),
        ("int8 a__b", "small letters"),
        ("int8 a_", "small letters"),
        ("int8 class", "no word of Python"),
        ("int8 get_fields_and_field_types", "small letters"),
        ("int8 x\nint16 x", "given twice"),
        ("int8<=3 x", "have a bound"),
        ("int8[0] x", "is not understood"),
        ("geometry_msgs/msg/Twist t", "write geometry_msgs/Twist"),
        ("float x", "write float64"),
        ("here/there/X x", "check its spelling"),
        ("bool B=maybe", "'maybe' is not understood"),
        ("int8 a\n---\nint8 b", "remove this ---"),
        ("\n".join(f"int8 x{i}" for i in range(201)), "more than 200"),
    ],
)
def test_misunderstood_lines_are_named(line: str, words: str) -> None:
    with pytest.raises(DefinitionError) as refusal:
        translated("here", "msg", "X", line)
    assert words in refusal.value.told.en
    assert re.search(r"[\u4e00-\u9fff]{2}", refusal.value.told.zh)


@given(st.text(alphabet="int8float64[]<=_ #\"'\n-.=aZ(){}\\", max_size=60), st.sampled_from(["msg", "srv", "action"]))
def test_any_text_is_translated_or_refused(text: str, kind: str) -> None:
    try:
        lines = translated("here", kind, "X", text)
    except DefinitionError as error:
        assert 1 <= error.line <= max(1, len(text.splitlines()))
        return
    (interface,) = parsed([lines]).values()
    for structure in interface.structures():
        compile(class_source(structure), "class", "exec")
