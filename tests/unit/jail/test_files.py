"""What a confined process may read."""

import os
from pathlib import Path

import pytest

from grader.jail import bounds, layers

SHIM = Path(__file__).parents[2] / "hostile" / "runner"


def test_readable_paths_hold_no_packages_but_the_allowed() -> None:
    packages = layers.allowed_packages()
    paths = layers.readable_paths(SHIM, packages)
    allowed = {part for name in packages for part in bounds.ALLOWED_PACKAGES[name]}
    for path in paths:
        parts = Path(path).parts
        assert not {"site-packages", "dist-packages"} & {parts[-1]}
        assert "site-packages" not in parts or parts[-1] in allowed or path == str(SHIM.resolve())
        for inner in ("site-packages", "dist-packages"):
            assert not os.path.exists(os.path.join(path, inner))


def test_readable_paths_do_not_hold_the_grader_or_the_assignments() -> None:
    root = Path(layers.__file__).parents[2]
    paths = [Path(path) for path in layers.readable_paths(SHIM, layers.allowed_packages())]
    for secret in (root / "grader" / "sandbox.py", root / "assignments", root / "pyproject.toml"):
        assert not any(path == secret or path in secret.parents for path in paths)


def test_the_shim_and_the_standard_library_are_readable() -> None:
    paths = layers.readable_paths(SHIM, {})
    assert paths[0] == str(SHIM.resolve())
    assert os.path.join(layers.standard_library(), "json") in paths


def test_library_directory_with_packages_is_listed_entry_by_entry(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    directory = tmp_path / "lib64"
    (directory / "python3.12" / "site-packages").mkdir(parents=True)
    (directory / "libc.so.6").touch()
    monkeypatch.setattr(bounds, "SHARED_LIBRARY_DIRECTORIES", (str(directory),))
    paths = layers.readable_paths(SHIM, {})
    assert str(directory / "libc.so.6") in paths
    assert not any("python3.12" in path and path.startswith(str(tmp_path)) for path in paths)


def test_reachable_by_others(open_path: Path) -> None:
    inner = open_path / "inner"
    inner.mkdir(mode=0o700)
    assert layers.reachable_by_others([str(inner)])
    assert not layers.reachable_by_others([str(inner / "file")])
