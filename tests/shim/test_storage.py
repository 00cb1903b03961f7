"""Which paths are a script's own, and which are those of an installation that happens to lie among them."""

from collections.abc import Callable
from typing import Any

import pytest

PACKAGES = "/home/teacher/.venv/lib/python3/site-packages"
LOOK = f"""
import sys
from importlib.machinery import ModuleSpec
from rclpy._storage.tree import Storage

class Finder:
    # as in a confined process, where numpy's folder is on no path
    @staticmethod
    def find_spec(name, path=None, target=None):
        return ModuleSpec(name, None, origin="{PACKAGES}/numpy/__init__.py") if name == "numpy" else None

sys.meta_path.append(Finder)
print(Storage().parts("%s") is None)
"""


@pytest.mark.parametrize("file", ["numpy/__init__.py", "numpy/lib/format.py", "numpy.libs/libopenblas.so"])
def test_an_installation_below_home_is_not_the_scripts(run_bare: Callable[..., Any], file: str) -> None:
    assert run_bare(LOOK % f"{PACKAGES}/{file}").stdout == "True\n"


def test_what_lies_beside_an_installation_is_the_scripts(run_bare: Callable[..., Any]) -> None:
    assert run_bare(LOOK % "/home/teacher/notes.txt").stdout == "False\n"
