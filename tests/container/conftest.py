"""The image that ``make image-test`` has built, unpacked, behind Docker's own filter of system calls."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from tools.image import profile
from tools.image.build import Image
from tools.image.runtime import Runtime


@pytest.fixture(scope="session")
def runtime(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Runtime]:
    """The way to run containers of the image."""
    built = os.environ.get("GRADER_IMAGE")
    if not built:
        pytest.skip("no image was built: make image-test builds one")
    folder = Path(built)
    unpacked = folder / "container"
    unpacked.mkdir()
    docker = tmp_path_factory.mktemp("docker")
    made = Runtime(unpacked, Image.load(folder), profile.resolve(profile.fetch(docker)))
    made.unpack()
    yield made
    made.remove()
