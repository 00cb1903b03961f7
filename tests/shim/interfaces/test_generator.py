"""The generated interface data is what its definitions say."""

import importlib.util
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest
from rclpy._interfaces.definitions import INTERFACES
from rosbags.typesys import Stores, get_typestore

ROOT = Path(__file__).resolve().parents[3]
SCRIPT = ROOT / "tools" / "generate_interfaces.py"


@pytest.fixture(scope="module")
def generator() -> ModuleType:
    spec = importlib.util.spec_from_file_location("generate_interfaces", SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


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
        ("Header header", "header std_msgs/msg/Header"),
        ("Vector3[] v", "v here/msg/Vector3[]"),
        ("bool[2] flags [true, false]", "flags boolean[2] [True, False]"),
        ("float32 F=1", "!F float 1.0"),
    ],
)
def test_lines(generator: ModuleType, line: str, expected: str) -> None:
    assert list(generator.structure("X", line, "here")) == ["=X", expected]


@pytest.mark.parametrize("line", ["float64", "float64[ x", "int8 x oops", "bool B=maybe"])
def test_misunderstood_lines_are_named(generator: ModuleType, tmp_path: Path, line: str) -> None:
    file = tmp_path / "here" / "msg" / "X.msg"
    file.parent.mkdir(parents=True)
    file.write_text(line)
    with pytest.raises(generator.DefinitionError, match=r"X\.msg"):
        generator.generate(tmp_path)
