"""The root directory that takes Landlock's place: what it shows, and when it has to be made again."""

import os
import stat
from pathlib import Path

import pytest

from grader.jail import prepared_root

pytestmark = pytest.mark.skipif(os.geteuid() != 0, reason="only root can make devices")


def test_it_shows_what_it_was_told_and_nothing_else(tmp_path: Path) -> None:
    library, place = tmp_path / "library", tmp_path / "root"
    (library / "secret").mkdir(parents=True)
    (library / "secret" / "solution.py").write_text("1")
    (library / "package").mkdir()
    (library / "package" / "module.py").write_text("2")
    (library / "link.py").symlink_to("package/module.py")
    (library / "su").write_text("3")
    (library / "su").chmod(0o4755)
    prepared_root.prepare([str(library)], [str(library / "secret")], place)
    inner = place / str(library).lstrip("/")
    assert sorted(os.listdir(inner)) == ["link.py", "package"]
    assert (inner / "link.py").read_text() == "2"
    assert stat.S_IMODE(inner.stat().st_mode) == stat.S_IMODE(place.stat().st_mode) == 0o711
    assert stat.S_ISCHR((place / "dev" / "null").stat().st_mode)


def test_a_file_that_others_may_change_is_copied(tmp_path: Path) -> None:
    library, place = tmp_path / "library", tmp_path / "root"
    library.mkdir()
    for name, mode, owner in (("own.py", 0o644, 0), ("open.py", 0o666, 0), ("foreign.py", 0o644, 60_706)):
        (library / name).write_text(name)
        (library / name).chmod(mode)
        os.chown(library / name, owner, owner)
    prepared_root.prepare([str(library)], [], place)
    shown = {path.name: path for path in (place / str(library).lstrip("/")).iterdir()}
    assert {path.stat().st_uid for path in shown.values()} == {0}
    assert {stat.S_IMODE(path.stat().st_mode) for path in shown.values()} == {0o644}
    assert {name for name, path in shown.items() if path.samefile(library / name)} == {"own.py"}
    assert shown["open.py"].read_text() == "open.py"
    os.chown(library / "own.py", 60_706, 0)
    assert not prepared_root.is_ready([str(library)], [], place)


def test_it_is_ready_until_its_sources_change(tmp_path: Path) -> None:
    library, place = tmp_path / "library", tmp_path / "root"
    library.mkdir()
    (library / "module.py").write_text("1")
    told = ([str(library)], [])
    assert not prepared_root.is_ready(*told, place)
    prepared_root.prepare(*told, place)
    (library / "__pycache__").mkdir()  # comes by itself
    (library / "__pycache__" / "module.pyc").write_text("1")
    assert prepared_root.is_ready(*told, place)
    place.chmod(0o777)
    assert not prepared_root.is_ready(*told, place)  # somebody else may have changed it
    place.chmod(0o711)
    (library / "other.py").write_text("2")
    assert not prepared_root.is_ready(*told, place)
    prepared_root.prepare(*told, place)
    assert prepared_root.is_ready(*told, place)
