"""Delete the PyBullet models that no script can read, for a small image: ``python -m grader.jail.models``."""

import shutil
import sys
from pathlib import Path

from grader.jail.bounds import PYBULLET_MODELS


def main() -> int:
    """Delete; return the exit code."""
    import pybullet_data

    folder, kept = Path(pybullet_data.getDataPath()), {*PYBULLET_MODELS.split(), "__pycache__"}
    for path in folder.iterdir():
        if path.name in kept:
            continue
        if path.is_dir():
            shutil.rmtree(path)
        else:
            path.unlink()
    return 0


if __name__ == "__main__":
    sys.exit(main())
