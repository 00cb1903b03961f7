"""Check the import layers with import-linter, with the shim's packages on the path.

A folder without `__init__.py` is not scanned, so the shim's packages are named as roots of their own in
`[tool.importlinter]`; they are found here.
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "grader" / "shim")]

from importlinter.cli import lint_imports  # noqa: E402

if __name__ == "__main__":
    sys.exit(lint_imports())
