"""Print which compiled modules of this Python, and which of the grader's libraries, cannot be imported."""

import importlib
import sysconfig
import warnings
from pathlib import Path

OWN = (
    "grader.service.composition",
    "grader.grading.child",
    "matplotlib.backends.backend_agg",
    "matplotlib.backends.backend_svg",
    "numpy.linalg",
    "numpy.random",
    "procrastinate",
    "psycopg",
    "psycopg_pool",
)

warnings.simplefilter("ignore")
compiled = sorted(path.name.split(".")[0] for path in Path(sysconfig.get_config_var("DESTSHARED")).glob("*.so"))
for name in (*compiled, *OWN):
    try:
        importlib.import_module(name)
    except ImportError:
        print(name)
