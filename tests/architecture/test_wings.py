"""What an installation may lack is imported when it is asked for: the core and the service begin without it."""

import subprocess
import sys

import pytest

from grader.contracts.extras import _MODULES

OPTIONAL = {module for modules in _MODULES.values() for module in modules}
SERVICE = {
    "fastapi",
    "uvicorn",
    "starlette",
    "jinja2",
    "httpx",
    "sqlmodel",
    "sqlalchemy",
    "alembic",
    "openpyxl",
}
WINGS = ("grader.live", "grader.outside", "grader.service", "grader.store", "grader.use_cases")


def imported_without(absent: set[str], module: str) -> set[str]:
    """Return the modules that come with `module` where those of `absent` are not installed."""
    program = (
        "import importlib, sys\n"
        f"sys.modules.update(dict.fromkeys({sorted(absent)}))\n"
        f"importlib.import_module({module!r})\n"
        "print(*sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return set(done.stdout.split())


@pytest.mark.parametrize("module", ["grader.commands.check", "grader.commands.run", "grader.grading.child"])
def test_the_core_needs_no_wing(module: str) -> None:
    present = imported_without(OPTIONAL | SERVICE, module)
    assert not {name for name in present if name.startswith(WINGS)}


@pytest.mark.parametrize(
    "module",
    [
        "grader.api",
        pytest.param("grader.service.composition", marks=pytest.mark.slow),
        pytest.param("grader.commands.serve", marks=pytest.mark.slow),
    ],
)
def test_the_service_needs_none_of_its_own_extras(module: str) -> None:
    assert module in imported_without(OPTIONAL - {"matplotlib"}, module)


def test_what_is_absent_cannot_be_imported() -> None:
    with pytest.raises(AssertionError, match="fastapi"):
        imported_without(SERVICE, "grader.api")
