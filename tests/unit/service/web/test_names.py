"""What the editor completes is what the shim has."""

import importlib.util
from pathlib import Path

ROOT = Path(__file__).parents[4]


def test_the_names_are_those_of_the_shim() -> None:
    path = ROOT / "tools" / "editor" / "names.py"
    spec = importlib.util.spec_from_file_location("editor_names", path)
    assert spec is not None
    assert spec.loader is not None
    names = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(names)
    assert names.OUT.read_text(encoding="utf-8") == names.written()
    assert "create_publisher" in names.names()["node"]
