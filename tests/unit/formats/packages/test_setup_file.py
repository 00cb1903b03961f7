"""What reading a hostile ``setup.py`` may take: the grader's own time."""

import pytest

from grader.formats.packages.setup_file import UNKNOWN, SetupFile

DEEP = [f"{'/'.join('abcdefghijklm')}/f{number}.py" for number in range(490)]
PLAIN = ["launch/a.launch.py", "launch/b.launch.py", "config/c.yaml"]


def setup(*lines: str) -> bytes:
    return "\n".join([*lines, "setup(name='p', data_files=[('share/p', found)], packages=more)"]).encode()


def test_the_searches_of_ordinary_packages_are_done() -> None:
    read = SetupFile(setup("found = glob('launch/*.py')", "more = find_packages(exclude=['test'])"), PLAIN)
    assert read.data_files() == [("share/p", ["launch/a.launch.py", "launch/b.launch.py"])]
    deep = SetupFile(setup("found = glob('**/*7.py')", "more = []"), DEEP)
    assert [len(paths) for _, paths in deep.data_files() or []] == [49]


@pytest.mark.parametrize(
    "search", ["glob('**/*')", f"glob('{'**/' * 300}*')", f"find_packages(exclude={['*'] * 99})"]
)
def test_searches_without_end_are_given_up(search: str) -> None:
    """Four thousand of them took ten minutes, as the grader's fault."""
    lines = [f"found = {search}" for _ in range(60)]
    read = SetupFile(setup(*lines, "more = found"), DEEP)
    assert (read.data_files(), read.strings("packages"), read.text("name")) == (None, None, "p")


def test_files_that_are_listed_again_and_again_are_given_up() -> None:
    again = b"[" + b"('share/p', found),\n" * 900 + b"("
    often = setup("found = glob('**/*')", "more = []").replace(b"[(", again)
    assert SetupFile(often, DEEP).data_files() is None


def test_sums_without_end_are_given_up() -> None:
    long = [f"found = {[0] * 1_900}".replace(",", ",\n"), *["more = found + found"] * 1_000, "found = []"]
    read = SetupFile(setup(*long), PLAIN)
    assert (read.arguments["packages"], read.text("name")) == (UNKNOWN, "p")
