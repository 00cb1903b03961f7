import os
import sys
from pathlib import Path

import pytest
from jinja2 import Environment

from grader.service.web.compiled import CompiledTemplates


class Counting(Environment):
    """Counts what it compiles."""

    compiled = 0

    def compile(self, *arguments: object, **options: object) -> object:  # type: ignore[override]
        self.compiled += 1
        return super().compile(*arguments, **options)  # type: ignore[call-overload]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    made = tmp_path / "templates"
    made.mkdir()
    write(made / "one.html", "{{ 1 + 1 }} turtles", 100)
    write(tmp_path / "pages.py", "", 100)
    return made


def write(path: Path, text: str, when_s: int) -> None:
    path.write_text(text)
    os.utime(path, (when_s, when_s))


def rendered(folder: Path) -> tuple[str, int]:
    """What a process that starts shows, and how many templates it compiles for that."""
    environment = Counting(loader=CompiledTemplates(folder, folder.parent / "pages.py"))
    return environment.get_template("one.html").render(), environment.compiled


def test_a_template_is_compiled_once_for_all_processes(folder: Path) -> None:
    assert [rendered(folder) for _ in range(2)] == [("2 turtles", 1), ("2 turtles", 0)]
    assert Environment(loader=CompiledTemplates(folder)).list_templates(["html"]) == ["one.html"]


@pytest.mark.parametrize("bytes_kept", [0, 10])
def test_a_file_that_was_cut_off_is_written_anew(folder: Path, bytes_kept: int) -> None:
    rendered(folder)
    (kept,) = (folder / "__pycache__").iterdir()
    kept.write_bytes(kept.read_bytes()[:bytes_kept])
    assert [rendered(folder) for _ in range(2)] == [("2 turtles", 1), ("2 turtles", 0)]


def test_a_changed_template_is_compiled_anew(folder: Path) -> None:
    rendered(folder)
    write(folder / "one.html", "{{ 2 + 2 }} turtles", 2_000_000_000)
    assert [rendered(folder) for _ in range(2)] == [("4 turtles", 1), ("4 turtles", 0)]


def test_so_is_one_once_it_would_be_compiled_otherwise(folder: Path) -> None:
    rendered(folder)
    write(folder.parent / "pages.py", "", 2_000_000_000)
    assert [rendered(folder) for _ in range(2)] == [("2 turtles", 1), ("2 turtles", 0)]


def test_where_nothing_can_be_written_templates_work_as_well(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder / "__pycache__").touch()  # a file, which no folder can be made of
    assert [rendered(folder) for _ in range(2)] == [("2 turtles", 1)] * 2
    (folder / "__pycache__").unlink()
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    assert [rendered(folder) for _ in range(2)] == [("2 turtles", 1)] * 2
