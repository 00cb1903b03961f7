"""Packages are compared by their modules, in whatever file a line is, and not by what ros2 pkg create wrote."""

from grader.formats.packages.bundle import bundled, code_of
from grader.similarity.fingerprints import grams
from grader.similarity.tokens import tokens_of
from tests.fakes.packages import DRIVE, HELPER, NAME, package_files, zipped


def hashes(files: dict[str, str]) -> set[int]:
    return set(grams(tokens_of(code_of(bundled(zipped(files))))).tolist())


def test_code_that_moved_to_another_module_is_still_alike() -> None:
    drive = f"{NAME}/drive.py"
    merged = package_files(**{drive: HELPER + DRIVE.format(name=NAME), f"{NAME}/helper.py": None})
    first, second = hashes(package_files()), hashes(merged)
    assert len(first & second) > 0.8 * len(first)


def test_what_every_package_has_is_not_compared() -> None:
    bare = package_files(**{f"{NAME}/drive.py": None, f"{NAME}/helper.py": None})
    assert not hashes(bare)
