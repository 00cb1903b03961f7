"""Programs in containers of the image."""

from pathlib import Path

from tools.image.runtime import Done, Runtime

SCRIPTS = {"/scripts": Path(__file__).parent / "scripts"}


def good(done: Done) -> str:
    """Return what a program printed, which must have ended well."""
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def python(runtime: Runtime, *arguments: str) -> str:
    """Return what the image's Python prints; the folder ``scripts`` is shown to it."""
    return good(runtime.run_program(["python", *arguments], shown=SCRIPTS))
